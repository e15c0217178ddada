#include "plumbline/solvers/verdict.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "plumbline/core/pose_frame.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/held_out_returns.h"
#include "plumbline/solvers/reduced/patch_energy.h"

namespace plumbline {
namespace {

constexpr double kRounding = 1e-9;  // share: measured points have single precision

// Of one held-out return: rho(d^2 / s^2), summed over the patches that it is on, of the seed's and
// of the state's surfaces.
struct HeldOutReturn {
  int num_patches = 0;
  double seed_error = 0.0;
  double state_error = 0.0;
};

class Judge {
 public:
  Judge(const SlamGraph& graph, const MeasuredSurface& surface, const FactorOptions& factors,
        ThreadPool* pool)
      : graph_(graph),
        surface_(surface),
        factors_(factors),
        noise_(NoiseOf(factors)),
        loss_(GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas)),
        pool_(pool) {}

  // Takes what these patches say of both states into account.
  void Hear(const SurfacePatches& cut, const std::vector<double>& seed,
            const std::vector<double>& state) {
    SurfacePatches fitted;
    fitted.patches = cut.patches;
    fitted.patch_of_return =
        WithoutHeldOut(graph_, cut.patch_of_return, int{SurfacePatches::kNone});
    for (std::size_t r = 0; r < surface_.normals.size(); ++r) {
      if (!HasNormal(r)) fitted.patch_of_return[r] = SurfacePatches::kNone;
    }
    std::vector<std::vector<SurfacePatch>> lines;
    const std::vector<double> energies = PatchEnergies(
        graph_, surface_, factors_, std::move(fitted), {&seed, &state}, pool_, &lines);
    seed_energy_ += energies[0];
    state_energy_ += energies[1];
    ++num_cuts_;
    AddErrors(cut.patch_of_return, lines, seed, state);
  }

  Verdict Conclude() const {
    Verdict verdict;
    verdict.with_relative_poses = !graph_.relative_poses().empty();
    verdict.seed_energy = seed_energy_ / num_cuts_;
    verdict.final_energy = state_energy_ / num_cuts_;
    verdict.energy_rounding =
        kRounding * (verdict.seed_energy + static_cast<double>(graph_.num_returns()));
    double sightings = 0.0;
    for (const HeldOutReturn& held_out : held_out_) {
      if (held_out.num_patches == 0) continue;
      ++verdict.num_held_out;
      sightings += held_out.num_patches;
      verdict.seed_held_out_error += held_out.seed_error;
      verdict.final_held_out_error += held_out.state_error;
    }
    if (verdict.num_held_out == 0) return verdict;
    const double change = (verdict.final_held_out_error - verdict.seed_held_out_error) / sightings;
    double squares = 0.0;
    for (const HeldOutReturn& held_out : held_out_) {
      const double expected = held_out.num_patches * change;
      squares += std::pow(held_out.state_error - held_out.seed_error - expected, 2);
    }
    verdict.seed_held_out_error /= sightings;
    verdict.final_held_out_error /= sightings;
    verdict.held_out_noise = std::sqrt(squares) / sightings;
    return verdict;
  }

  std::vector<PoseChange> ChangesOfPoses() const {
    std::vector<PoseChange> changes(graph_.num_poses());
    std::size_t i = 0;
    for (int s = 0; s < graph_.num_scans(); ++s) {
      PoseChange& change = changes[graph_.scan(s).pose];
      HeldOutReturns::ForEachOf(graph_, s, [&](std::size_t) {
        const HeldOutReturn& held_out = held_out_[i++];
        change += {held_out.num_patches, held_out.seed_error, held_out.state_error,
                   std::pow(held_out.state_error - held_out.seed_error, 2)};
      });
    }
    return changes;
  }

 private:
  bool HasNormal(std::size_t r) const { return !surface_.normals[r].isZero(0.0f); }

  // lines: of the patches, at the seed and at the state.
  void AddErrors(const std::vector<int>& patch_of_return,
                 const std::vector<std::vector<SurfacePatch>>& lines,
                 const std::vector<double>& seed, const std::vector<double>& state) {
    std::size_t i = 0;
    for (int s = 0; s < graph_.num_scans(); ++s) {
      const int pose = graph_.scan(s).pose;
      const PoseFrame at_seed(&seed[3 * pose]), at_state(&state[3 * pose]);
      const Eigen::Vector2d laser = graph_.LaserOfScan(s).robot_from_laser.translation();
      HeldOutReturns::ForEachOf(graph_, s, [&](std::size_t r) {
        if (i == held_out_.size()) held_out_.emplace_back();
        HeldOutReturn& held_out = held_out_[i++];
        const int patch = patch_of_return[r];
        if (patch == SurfacePatches::kNone || !HasNormal(r)) return;
        const Eigen::Vector2d in_robot = surface_.points[r].cast<double>();
        ++held_out.num_patches;
        held_out.seed_error += Error(in_robot, in_robot - laser, at_seed, lines[0][patch]);
        held_out.state_error += Error(in_robot, in_robot - laser, at_state, lines[1][patch]);
      });
    }
  }

  double Error(const Eigen::Vector2d& in_robot, const Eigen::Vector2d& beam, const PoseFrame& frame,
               const SurfacePatch& patch) const {
    const double distance = patch.Distance(frame.Rotate(in_robot) + frame.translation());
    const double variance =
        noise_.surface_variance + noise_.BeamVariance(frame.Rotate(beam), patch.normal);
    return loss_.Rho(distance * distance / variance);
  }

  const SlamGraph& graph_;
  const MeasuredSurface& surface_;
  const FactorOptions& factors_;
  const SurfaceNoise noise_;
  const GemanMcClure loss_;
  ThreadPool* pool_;
  int num_cuts_ = 0;
  double seed_energy_ = 0.0, state_energy_ = 0.0;
  std::vector<HeldOutReturn> held_out_;  // of the graph, in order of scans
};

}  // namespace

double Verdict::LargestHeldOutError() const {
  const double by_chance = (1.0 + kRounding) * seed_held_out_error + 2.0 * held_out_noise;
  return with_relative_poses ? std::max(by_chance, 2.0 * seed_held_out_error) : by_chance;
}

std::string Verdict::Text() const {
  std::ostringstream text;
  text << "energy under the patches of both " << seed_energy << " -> " << final_energy << ", "
       << num_held_out << " held-out returns: mean squared distance " << seed_held_out_error
       << " -> " << final_held_out_error << " sigmas^2";
  if (!LowersEnergy()) text << "; the energy is not lower";
  if (!KeepsHeldOutError()) {
    text << "; the held-out returns fit worse, beyond the " << LargestHeldOutError() << " allowed";
  }
  if (num_worse_stretches > 0) {
    text << "; " << num_worse_stretches << " stretches of the drive fit clearly worse";
  }
  return text.str();
}

Verdict CompareWithSeed(const SlamGraph& graph, const MeasuredSurface& surface,
                        const FactorOptions& factors, const JudgedState& seed,
                        const JudgedState& state, ThreadPool* pool,
                        std::vector<PoseChange>* changes) {
  Judge judge(graph, surface, factors, pool);
  judge.Hear(seed.patches, seed.poses, state.poses);
  judge.Hear(state.patches, seed.poses, state.poses);
  if (changes != nullptr) *changes = judge.ChangesOfPoses();
  return judge.Conclude();
}

}  // namespace plumbline
