#include "plumbline/solvers/seed.h"

#include <cstddef>
#include <string>
#include <utility>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/front_end/correct_odometry.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_clock.h"
#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/solvers/loop_closure/close_all_loops.h"

namespace plumbline {
namespace {

std::vector<Pose2> OdometryOf(const SequentialTrajectory& trajectory, const SlamGraph& graph) {
  std::vector<Pose2> motions;
  for (const OdometryConstraint& step : graph.odometry()) {
    const bool corrected = step.to == step.from + 1;
    motions.push_back(corrected ? trajectory.odometry[step.to] : step.from_from_to);
  }
  return motions;
}

// Takes the errors that stay the same for the whole log out of the odometry.
OdometryNoiseReport MeasureOdometry(const SlamGraph& graph, const MotionOptions& motion,
                                    SequentialTrajectory* trajectory) {
  const ClockOffset clock_offset = EstimateClockOffset(graph, *trajectory);
  SequentialTrajectory in_time = *trajectory;
  if (clock_offset.IsSignificant()) {
    in_time.odometry = OdometryInTime(graph, in_time.odometry, clock_offset.value_s);
  }
  OdometryNoiseReport report = EstimateOdometryNoise(in_time, motion);
  report.clock_offset = clock_offset;
  for (Pose2& step : in_time.odometry) step = CorrectStep(step, report);
  CorrectOdometry(std::move(in_time.odometry), motion, trajectory);
  return report;
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
  const bool is_prediction = LacksOdometry(graph);
  PLUMBLINE_RETURN_IF_ERROR(
      SeedSequentially(options.sequential, is_prediction ? PredictionPrior(motion) : motion, graph,
                       surfaces, progress, pool, &trajectory, &report->sequential));
  if (is_prediction) {
    report->odometry_noise = MeasurePredictionNoise(graph, trajectory.world_from_robot, motion);
  } else {
    report->odometry_noise = MeasureOdometry(graph, motion, &trajectory);
  }
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

}  // namespace plumbline
