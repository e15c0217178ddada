#include "plumbline/solvers/loop_closure/seed_drive.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/solvers/front_end/correct_odometry.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_clock.h"
#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/loop_closure/close_all_loops.h"
#include "plumbline/solvers/loop_closure/moving_returns.h"

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

// Whether an offset of the clocks makes the turns of odometry and scans agree better. What looks
// like one may be the jitter of the stamps: the odometry of intel's first third fits best 50 ms
// later, and is then in error by half as much again.
bool Explains(const OdometryNoiseReport& in_time, const OdometryNoiseReport& as_given) {
  return !in_time.rotation.estimated || !as_given.rotation.estimated ||
         in_time.motion.rotation_per_rotation < as_given.motion.rotation_per_rotation;
}

// Takes the errors that stay the same for the whole log out of the odometry.
OdometryNoiseReport MeasureOdometry(const SlamGraph& graph, const MotionOptions& motion,
                                    SequentialTrajectory* trajectory) {
  const ClockOffset clock_offset = EstimateClockOffset(graph, *trajectory);
  OdometryNoiseReport report = EstimateOdometryNoise(*trajectory, motion);
  std::vector<Pose2> odometry = trajectory->odometry;
  if (clock_offset.IsSignificant()) {
    SequentialTrajectory in_time = *trajectory;
    in_time.odometry = OdometryInTime(graph, odometry, clock_offset.value_s);
    const OdometryNoiseReport report_in_time = EstimateOdometryNoise(in_time, motion);
    if (Explains(report_in_time, report)) {
      report = report_in_time;
      report.clock_offset = clock_offset;
      odometry = std::move(in_time.odometry);
    }
  } else {
    report.clock_offset = clock_offset;
  }
  for (Pose2& step : odometry) step = CorrectStep(step, report);
  CorrectOdometry(std::move(odometry), motion, trajectory);
  return report;
}

Status CheckOptions(const SeedingOptions& options, const MotionOptions& motion) {
  std::string error;
  const bool good = options.Check(&error) && motion.Check(&error);
  return good ? Status::Ok() : Status::InvalidArgument(error);
}

Status CheckSurface(const MeasuredSurface& surface, const SlamGraph& graph) {
  if (surface.normals.size() == graph.num_returns()) return Status::Ok();
  return Status::InvalidArgument("seeding needs one normal per return, " +
                                 std::to_string(graph.num_returns()) + ", but got " +
                                 std::to_string(surface.normals.size()));
}

// From scan to scan.
Status MatchDrive(const SeedingOptions& options, const MotionOptions& motion,
                  const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
                  SequentialTrajectory* trajectory, SeedingReport* report) {
  const SlamGraph& graph = surfaces->graph();
  const bool is_prediction = LacksOdometry(graph);
  PLUMBLINE_RETURN_IF_ERROR(
      SeedSequentially(options.sequential, is_prediction ? PredictionPrior(motion) : motion,
                       progress, pool, surfaces, trajectory, &report->sequential));
  if (is_prediction) {
    report->odometry_noise = MeasurePredictionNoise(graph, trajectory->world_from_robot, motion);
  } else {
    report->odometry_noise = MeasureOdometry(graph, motion, trajectory);
  }
  return Status::Ok();
}

// People around the robot pull the matching along with them: what moves is left out. Says whether
// there is so much of it that the drive is to be matched once more.
bool FindWhatMoves(const ScanSurfaces& surfaces, const SequentialTrajectory& matched,
                   ThreadPool* pool, SeedingReport* report) {
  std::vector<std::size_t> moving =
      FindMovingReturnsOfDrive(surfaces, matched.world_from_robot, pool);
  if (moving.empty()) return false;
  report->moving_share = static_cast<double>(moving.size()) /
                         static_cast<double>(surfaces.graph().num_returns_of_all());
  report->corrections.moving_returns = std::move(moving);
  return true;
}

// Closes the loops of a drive that was matched.
Status CloseDrive(ScanSurfaces surfaces, const SeedingProgress& progress, ThreadPool* pool,
                  SequentialTrajectory trajectory, SeededDrive* drive, SeedingReport* report) {
  SeededDrive closed;
  PLUMBLINE_RETURN_IF_ERROR(CloseAllLoops(report->odometry_noise.motion, surfaces, progress,
                                          nullptr, pool, &trajectory, &closed.keys, report));
  report->corrections.odometry = OdometryOf(trajectory, surfaces.graph());
  closed.world_from_robot = std::move(trajectory.world_from_robot);
  closed.surfaces = std::move(surfaces).TakeKept();
  closed.matched = std::move(trajectory);
  closed.matched.world_from_robot = report->sequential_poses;
  *drive = std::move(closed);
  return Status::Ok();
}

}  // namespace

Status SeedDrive(const SeedingOptions& options, const MotionOptions& motion,
                 const MeasuredSurface& surface, const SeedingProgress& progress, ThreadPool* pool,
                 const SlamGraph& graph, SeededDrive* drive, SeedingReport* report) {
  PLUMBLINE_RETURN_IF_ERROR(CheckOptions(options, motion));
  PLUMBLINE_RETURN_IF_ERROR(CheckSurface(surface, graph));
  if (graph.peers() != nullptr) {
    return Status::InvalidArgument("the graph is a part of one that processes share");
  }
  SequentialTrajectory trajectory;
  {
    ScanSurfaces surfaces(graph, surface);
    PLUMBLINE_RETURN_IF_ERROR(
        MatchDrive(options, motion, progress, pool, &surfaces, &trajectory, report));
    if (!FindWhatMoves(surfaces, trajectory, pool, report)) {
      return CloseDrive(std::move(surfaces), progress, pool, std::move(trajectory), drive, report);
    }
  }
  const SlamGraph marked = graph.Corrected(report->corrections);
  MeasuredSurface surface_at_rest = surface;
  DropMovingNormals(marked, &surface_at_rest.normals);
  ScanSurfaces at_rest(marked, surface_at_rest);
  PLUMBLINE_RETURN_IF_ERROR(
      MatchDrive(options, motion, progress, pool, &at_rest, &trajectory, report));
  return CloseDrive(std::move(at_rest), progress, pool, std::move(trajectory), drive, report);
}

Status SeedSharedDrive(const SeedingOptions& options, const MotionOptions& motion,
                       const SeedingProgress& progress, ThreadPool* pool, SlamGraph* part,
                       MeasuredSurface* surface, SeededDrive* drive, SeedingReport* report) {
  PLUMBLINE_RETURN_IF_ERROR(CheckOptions(options, motion));
  PLUMBLINE_RETURN_IF_ERROR(FirstFailure(part->peers(), CheckSurface(*surface, *part)));
  const SeedingProgress tell = Unstoppable(progress);
  SequentialTrajectory trajectory;
  bool moves = false;
  {
    ScanSurfaces of_time(*part, *surface);
    PLUMBLINE_RETURN_IF_ERROR(
        MatchDrive(options, motion, tell, pool, &of_time, &trajectory, report));
    moves = FindWhatMoves(of_time, trajectory, pool, report);
  }
  if (moves) {
    *part = std::move(*part).Corrected(report->corrections);
    DropMovingNormals(*part, &surface->normals);
    ScanSurfaces at_rest(*part, *surface);
    PLUMBLINE_RETURN_IF_ERROR(
        MatchDrive(options, motion, tell, pool, &at_rest, &trajectory, report));
  }
  ShareAnewByPlace(PoseArray(trajectory.world_from_robot), part, surface);
  ScanSurfaces surfaces =
      ScanSurfaces(*part, *surface).WithKept(ScansOf(trajectory.keyframes), pool);
  return CloseDrive(std::move(surfaces), tell, pool, std::move(trajectory), drive, report);
}

}  // namespace plumbline
