#include "plumbline/solvers/verdict.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "plumbline/core/pose_frame.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/held_out_returns.h"
#include "plumbline/solvers/reduced/patch_energy.h"

namespace plumbline {
namespace {

// rho(d^2 / s^2) of every held-out return on a patch, in order.
std::vector<double> HeldOutErrors(const SlamGraph& graph, const MeasuredSurface& surface,
                                  const FactorOptions& factors,
                                  const std::vector<int>& patch_of_return,
                                  const std::vector<SurfacePatch>& patches,
                                  const std::vector<double>& poses) {
  const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
  const SurfaceNoise noise = NoiseOf(factors);
  std::vector<double> errors;
  for (int s = 0; s < graph.num_scans(); ++s) {
    const PoseFrame frame(&poses[3 * graph.scan(s).pose]);
    const Eigen::Vector2d laser = graph.LaserOfScan(s).robot_from_laser.translation();
    HeldOutReturns::ForEachOf(graph, s, [&](std::size_t r) {
      if (patch_of_return[r] == SurfacePatches::kNone) return;
      const SurfacePatch& patch = patches[patch_of_return[r]];
      const Eigen::Vector2d in_robot = surface.points[r].cast<double>();
      const double distance = patch.Distance(frame.Rotate(in_robot) + frame.translation());
      const double variance =
          noise.surface_variance + noise.BeamVariance(frame.Rotate(in_robot - laser), patch.normal);
      errors.push_back(loss.Rho(distance * distance / variance));
    });
  }
  return errors;
}

struct MeanAndError {
  double mean = 0.0;
  double standard_error = 0.0;
};

MeanAndError MeanOf(const std::vector<double>& values) {
  MeanAndError result;
  const double n = static_cast<double>(values.size());
  for (const double value : values) result.mean += value / n;
  double squares = 0.0;
  for (const double value : values) squares += std::pow(value - result.mean, 2);
  if (n > 1.0) result.standard_error = std::sqrt(squares / (n * (n - 1.0)));
  return result;
}

}  // namespace

std::string Verdict::Text() const {
  std::ostringstream text;
  text << "energy under the seed's patches " << seed_energy << " -> " << final_energy << ", "
       << num_held_out << " held-out returns: mean squared distance " << seed_held_out_error
       << " -> " << final_held_out_error << " sigmas^2";
  if (!LowersEnergy()) text << "; the energy is not lower";
  if (!LowersHeldOutError()) {
    text << "; the held-out returns fit worse, by more than chance (" << held_out_noise << ")";
  }
  return text.str();
}

Verdict CompareWithSeed(const SlamGraph& graph, const MeasuredSurface& surface,
                        const FactorOptions& factors, const SurfacePatches& seed_patches,
                        const std::vector<double>& seed, const std::vector<double>& poses,
                        ThreadPool* pool) {
  SurfacePatches fitted;
  fitted.patches = seed_patches.patches;
  fitted.patch_of_return =
      WithoutHeldOut(graph, seed_patches.patch_of_return, int{SurfacePatches::kNone});
  std::vector<std::vector<SurfacePatch>> lines;
  const std::vector<double> energies =
      PatchEnergies(graph, surface, factors, std::move(fitted), {&seed, &poses}, pool, &lines);

  const auto errors = [&](const std::vector<double>& state, std::size_t i) {
    return HeldOutErrors(graph, surface, factors, seed_patches.patch_of_return, lines[i], state);
  };
  const std::vector<double> before = errors(seed, 0), after = errors(poses, 1);
  std::vector<double> change(after.size());
  std::transform(after.begin(), after.end(), before.begin(), change.begin(), std::minus<>());

  constexpr double kRounding = 1e-9;  // share: measured points have single precision
  Verdict verdict;
  verdict.seed_energy = energies[0];
  verdict.final_energy = energies[1];
  verdict.energy_rounding = kRounding * (energies[0] + static_cast<double>(graph.num_returns()));
  verdict.num_held_out = after.size();
  verdict.seed_held_out_error = MeanOf(before).mean;
  verdict.final_held_out_error = MeanOf(after).mean;
  verdict.held_out_noise = MeanOf(change).standard_error;
  return verdict;
}

}  // namespace plumbline
