#include "plumbline/core/fixed_poses.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

namespace plumbline {
namespace {

bool IsInPlace(const FixedPose& fixed, const MapState& state) {
  const Pose2 pose = state.WorldFromRobot(fixed.pose);
  const Pose2& held = fixed.world_from_robot;
  return pose.x == held.x && pose.y == held.y && pose.yaw == held.yaw;
}

}  // namespace

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
  if (!state->points.empty()) CarryPoints(graph, before, state);
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

}  // namespace plumbline
