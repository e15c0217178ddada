#include "plumbline/solvers/solver_input.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/solvers/solver.h"

namespace plumbline {
namespace {

// Names the first block of `size` entries that is not within reach.
Status CheckReach(const char* name, const std::vector<double>& values, std::size_t size) {
  const auto bad = std::find_if_not(values.begin(), values.end(), IsWithinReach);
  if (bad == values.end()) return Status::Ok();
  return Status::InvalidArgument(
      std::string(name) + " " + std::to_string((bad - values.begin()) / size) +
      " of the state is " + (std::isfinite(*bad) ? "beyond 1e8 m or rad" : "not finite"));
}

bool IsInPlace(const FixedPose& fixed, const MapState& state) {
  const Pose2 pose = state.WorldFromRobot(fixed.pose);
  const Pose2& held = fixed.world_from_robot;
  return pose.x == held.x && pose.y == held.y && pose.yaw == held.yaw;
}

}  // namespace

Status CheckSolverInput(const SolverOptions& options, const SlamGraph& graph,
                        const MapState& state) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  PLUMBLINE_RETURN_IF_ERROR(CheckStateSize(graph, state));
  PLUMBLINE_RETURN_IF_ERROR(CheckReach("pose", state.poses, 3));
  PLUMBLINE_RETURN_IF_ERROR(CheckReach("point", state.points, 2));
  if (options.MovesPosesOnly()) {
    if (!graph.relative_poses().empty()) return Status::Ok();
    return Status::InvalidArgument("the graph has no relative poses, and the solver " +
                                   std::string(SolverOf(options).name()) +
                                   " looks at nothing else");
  }
  if (graph.num_returns() > 0) return Status::Ok();
  return Status::InvalidArgument("the graph has no laser returns: nothing to build a map of");
}

Status CheckStateSize(const SlamGraph& graph, const MapState& state) {
  const std::size_t num_pose_coordinates = 3 * static_cast<std::size_t>(graph.num_poses());
  const std::size_t num_point_coordinates = 2 * graph.num_returns();
  if (state.poses.size() == num_pose_coordinates && state.points.size() == num_point_coordinates) {
    return Status::Ok();
  }
  return Status::InvalidArgument(
      "the graph has " + std::to_string(graph.num_poses()) + " poses and " +
      std::to_string(graph.num_returns()) + " returns, which takes " +
      std::to_string(num_pose_coordinates) + " and " + std::to_string(num_point_coordinates) +
      " coordinates, but the state has " + std::to_string(state.poses.size()) + " and " +
      std::to_string(state.points.size()) + "; see SlamGraph::ExtendState");
}

bool IsAtFixedPoses(const SlamGraph& graph, const MapState& state) {
  return std::all_of(graph.fixed_poses().begin(), graph.fixed_poses().end(),
                     [&](const FixedPose& fixed) { return IsInPlace(fixed, state); });
}

void PutAtFixedPoses(const SlamGraph& graph, MapState* state) {
  if (graph.fixed_poses().empty()) return;
  const std::vector<double> before = state->poses;
  const FixedPose& first = graph.fixed_poses().front();
  if (!IsInPlace(first, *state)) {
    const Pose2 motion = first.world_from_robot * state->WorldFromRobot(first.pose).Inverse();
    for (int pose = 0; pose < state->num_poses(); ++pose) {
      state->SetPose(pose, motion * state->WorldFromRobot(pose));
    }
  }
  for (const FixedPose& fixed : graph.fixed_poses()) {
    state->SetPose(fixed.pose, fixed.world_from_robot);
  }
  CarryPoints(graph, before, state);
}

void CarryPoints(const SlamGraph& graph, const std::vector<double>& poses_before, MapState* state) {
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& scan = graph.scan(s);
    const auto before = poses_before.begin() + 3 * scan.pose;
    if (std::equal(before, before + 3, state->poses.begin() + 3 * scan.pose)) continue;
    const Pose2 now_from_before = state->WorldFromRobot(scan.pose) * Pose2(&*before).Inverse();
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      Eigen::Map<Eigen::Vector2d> point(&state->points[2 * r]);
      point = now_from_before * Eigen::Vector2d(point);
    }
  }
}

SolverSummary SolverFailure(const SolverOptions& options, const Status& status) {
  SolverSummary failure;
  failure.solver = SolverOf(options).name();
  failure.message = status.message();
  return failure;
}

SolverSummary CatchFailures(const SolverOptions& options,
                            const std::function<SolverSummary()>& solve) {
  SolverSummary summary;
  const Status status = CatchExceptions([&] {
    summary = solve();
    return Status::Ok();
  });
  if (!status.ok()) summary = SolverFailure(options, status);
  return summary;
}

}  // namespace plumbline
