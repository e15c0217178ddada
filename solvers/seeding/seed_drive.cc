#include "plumbline/solvers/seeding/seed_drive.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/match_drive.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/loop_closure/moving_returns.h"
#include "plumbline/solvers/seeding/close_all_loops.h"
#include "plumbline/solvers/seeding/rematch_given_poses.h"

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
  if (!trajectory.given_poses.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(
        RematchGivenPoses(report->odometry_noise.motion, surfaces, progress, pool, &trajectory));
  }
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
