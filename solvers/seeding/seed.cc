#include "plumbline/solvers/seeding/seed.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/solvers/seeding/correct_odometry.h"
#include "plumbline/solvers/seeding/seed_pose_graph.h"
#include "plumbline/solvers/seeding/surface_points.h"
#include "plumbline/solvers/solve.h"

namespace plumbline {
namespace {

bool IsAlarming(const LoopClosingReport& loops, const MapConsistency& consistency) {
  // Two weak signs together are one: what contradicts a little, and a doubt or loops left open.
  const bool in_doubt =
      !loops.doubts.empty() || (loops.num_closures == 0 && !loops.matches.empty());
  return consistency.IsContradictory() ||
         (in_doubt && consistency.Ratio() > MapConsistency::kSuspiciousRatio) ||
         loops.IsUnresolved();
}

std::vector<Pose2> OdometryOf(const SequentialTrajectory& trajectory, const SlamGraph& graph) {
  std::vector<Pose2> motions;
  for (const OdometryConstraint& step : graph.odometry()) {
    const bool corrected = step.to == step.from + 1;
    motions.push_back(corrected ? trajectory.odometry[step.to] : step.from_from_to);
  }
  return motions;
}

Status SeedChecked(const SeedingOptions& options, const MotionOptions& motion,
                   const std::vector<Eigen::Vector2f>& normals, const SeedingProgress& progress,
                   ThreadPool* pool, const SlamGraph& graph, MapState* state,
                   SeedingReport* report) {
  const DefaultFloatEnvironment float_environment;
  std::string error;
  if (!options.Check(&error) || !motion.Check(&error)) return Status::InvalidArgument(error);
  if (normals.size() != graph.num_returns()) {
    return Status::InvalidArgument("seeding needs one normal per return, " +
                                   std::to_string(graph.num_returns()) + ", but got " +
                                   std::to_string(normals.size()));
  }
  const std::vector<SurfacePoints> surfaces =
      ThinnedSurfacePoints(graph, normals, kPointSpacingM, pool);
  SequentialTrajectory trajectory;
  PLUMBLINE_RETURN_IF_ERROR(SeedSequentially(options.sequential, motion, graph, surfaces, progress,
                                             pool, &trajectory, &report->sequential));
  report->odometry_noise = EstimateOdometryNoise(trajectory, motion);
  CorrectOdometry(report->odometry_noise, motion, &trajectory);
  PLUMBLINE_RETURN_IF_ERROR(CloseAllLoops(report->odometry_noise.motion, graph, surfaces, progress,
                                          pool, &trajectory, report));
  report->corrections.odometry = OdometryOf(trajectory, graph);
  MapState seed;
  seed.poses = PoseArray(trajectory.world_from_robot);
  seed.points = graph.MeasuredMap(seed.poses);
  *state = std::move(seed);
  return Status::Ok();
}

}  // namespace

bool SeedingReport::Repaired() const {
  return std::any_of(loops.doubts.begin(), loops.doubts.end(),
                     [](const DoubtfulStep& doubt) { return doubt.broken; });
}

bool SeedingOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(sequential);
  return true;
}

Status SeedGraph(const SeedingOptions& options, const MotionOptions& motion,
                 const std::vector<Eigen::Vector2f>& normals, const SeedingProgress& progress,
                 ThreadPool* pool, const SlamGraph& graph, MapState* state, SeedingReport* report) {
  return CatchExceptions(
      [&] { return SeedChecked(options, motion, normals, progress, pool, graph, state, report); });
}

Status SeedGraph(const SeedingOptions& options, const SolverOptions& solver_options,
                 const SlamGraph& graph, MapState* state, SeedingReport* report) {
  return CatchExceptions([&] {
    std::string error;
    if (!solver_options.Check(&error)) return Status::InvalidArgument(error);
    const FactorOptions& factors = solver_options.factors;
    ThreadPool pool(solver_options.num_threads);
    return SeedChecked(options, factors.motion,
                       EstimateReturnNormals(graph, NormalOptionsFor(factors.beam), &pool), nullptr,
                       &pool, graph, state, report);
  });
}

Status CloseAllLoops(const MotionOptions& motion, const SlamGraph& graph,
                     const std::vector<SurfacePoints>& surfaces, const SeedingProgress& progress,
                     ThreadPool* pool, SequentialTrajectory* trajectory, SeedingReport* report) {
  MapHypothesis best;
  PLUMBLINE_RETURN_IF_ERROR(SearchMapHypotheses(motion, graph, surfaces, progress, pool,
                                                *trajectory, &best, &report->hypotheses));
  report->pose_graph = SeedPoseGraph(best.keys, best.start, motion);
  report->alarm = IsAlarming(best.loops, best.consistency);
  report->loops = std::move(best.loops);
  report->consistency = std::move(best.consistency);
  report->sequential_poses = std::move(best.start.world_from_robot);
  trajectory->world_from_robot = std::move(best.world_from_robot);
  return Status::Ok();
}

}  // namespace plumbline
