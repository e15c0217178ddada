#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/range_beam_factor.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_energy.h"
#include "plumbline/solvers/reduced/surface_patches.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/solvers/solver_input.h"

namespace plumbline {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kScansPerChunk = 16;

// The lines that a solver of this kind would draw the points to.
std::vector<TangentLine> LinesOf(const SolverOptions& options, const SlamGraph& graph,
                                 const MapState& state, ThreadPool* pool) {
  const FactorOptions& factors = options.factors;
  const MeasuredSurface surface = MeasureSurface(graph, NormalOptionsFor(factors.beam), pool);
  if (options.association.neighborhood == NeighborhoodType::kNearest) {
    return LinesFromNearest(graph, state, surface.normals, options.association, pool);
  }
  std::vector<TangentLine> lines =
      LinesFromRadius(graph, state.poses, surface, options.association, FineRadius(options), pool);
  if (!options.IsOverPatches()) return lines;
  SurfacePatches cut = CutIntoPatches(graph, state.poses, surface,
                                      PatchOptionsFor(factors, options.association), pool);
  ReturnCompressor compressor(graph, surface, NoiseOf(factors), pool);
  PatchSightings sightings = compressor.LayOut(cut.patches.size(), cut.patch_of_return);
  SettleLines(compressor, FramesOf(state.poses), factors.manifold.robust_gate_sigmas, pool,
              &sightings, &cut.patches);
  AddPatchLines(cut, &lines);
  return lines;
}

std::vector<Eigen::Vector3d> EdgeResiduals(const std::vector<PoseEdge>& edges,
                                           const std::vector<double>& poses) {
  std::vector<Eigen::Vector3d> residuals(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    edges[i].residual.Evaluate(&poses[3 * edges[i].from], &poses[3 * edges[i].to],
                               residuals[i].data(), nullptr, nullptr);
  }
  return residuals;
}

void EvaluateScan(const FactorOptions& factors, const SlamGraph& graph, const MapState& state,
                  const std::vector<TangentLine>& lines, const ScanEntry& scan,
                  Residuals* residuals) {
  const LaserReturns& returns = graph.returns();
  const BeamFrame frame =
      MakeBeamFrame(&state.poses[3 * scan.pose], graph.laser(scan.laser).robot_from_laser);
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    const double* point = &state.points[2 * r];
    Eigen::Vector2d& beam = residuals->beams[r];
    if (!EvaluateRangeBeam(frame, point, returns.range_m[r], returns.bearing_rad[r],
                           1.0 / factors.beam.sigma_range_m, 1.0 / factors.beam.sigma_bearing_rad,
                           beam.data(), nullptr, nullptr)) {
      beam.setConstant(kUndefined);
    }
    if (Associations::HasLine(lines[r])) {
      EvaluateManifold(lines[r], point, 1.0 / factors.manifold.sigma_m, &residuals->surfaces[r],
                       nullptr);
    }
  }
}

Status EvaluateChecked(const SolverOptions& options, const SlamGraph& graph, const MapState& state,
                       Residuals* residuals) {
  PLUMBLINE_RETURN_IF_ERROR(CheckSolverInput(options, graph, state));
  ThreadPool pool(options.num_threads);
  const PoseTerms terms(graph, options.factors);
  Residuals result;
  result.odometry = EdgeResiduals(terms.motions, state.poses);
  result.relative_poses = EdgeResiduals(terms.relative_poses, state.poses);
  result.beams.resize(graph.num_returns());
  result.surfaces.assign(graph.num_returns(), kUndefined);
  const std::vector<TangentLine> lines = LinesOf(options, graph, state, &pool);
  pool.ForEachChunk(graph.num_scans(), kScansPerChunk,
                    [&](std::size_t, std::size_t begin, std::size_t end) {
                      for (std::size_t s = begin; s < end; ++s) {
                        EvaluateScan(options.factors, graph, state, lines,
                                     graph.scan(static_cast<int>(s)), &result);
                      }
                    });
  const auto bad = std::find_if(result.beams.begin(), result.beams.end(),
                                [](const Eigen::Vector2d& beam) { return beam.hasNaN(); });
  if (bad != result.beams.end()) {
    return Status::InvalidArgument("point " + std::to_string(bad - result.beams.begin()) +
                                   " of the state lies on its laser: it has no bearing");
  }
  *residuals = std::move(result);
  return Status::Ok();
}

}  // namespace

Status EvaluateResiduals(const SolverOptions& options, const SlamGraph& graph,
                         const MapState& state, Residuals* residuals) {
  const DefaultFloatEnvironment float_environment;
  return CatchExceptions([&] { return EvaluateChecked(options, graph, state, residuals); });
}

}  // namespace plumbline
