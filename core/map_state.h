#ifndef PLUMBLINE_CORE_MAP_STATE_H_
#define PLUMBLINE_CORE_MAP_STATE_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// The unknowns of a mapping problem: where every pose and every map point is. A value that goes
/// with one SlamGraph, which holds the measurements: copied, returned and compared.
///
/// Flat arrays, which are the parameter blocks of the solvers.
struct MapState {
  std::vector<double> poses;   ///< x, y [m], yaw [rad] of world_from_robot, three numbers per pose
  std::vector<double> points;  ///< x, y [m] in the world, two numbers per return

  /// Number of poses.
  int num_poses() const { return static_cast<int>(poses.size() / 3); }

  /// A pose. Needs a known id.
  Pose2 WorldFromRobot(int pose_id) const {
    return Pose2(&poses[3 * static_cast<std::size_t>(pose_id)]);
  }

  /// Moves a pose, and no map point: see SlamGraph::MeasuredMap. Needs a known id.
  void SetPose(int pose_id, const Pose2& world_from_robot) {
    double* block = &poses[3 * static_cast<std::size_t>(pose_id)];
    block[0] = world_from_robot.x;
    block[1] = world_from_robot.y;
    block[2] = world_from_robot.yaw;
  }
};

/// Exactly: the same numbers.
inline bool operator==(const MapState& a, const MapState& b) {
  return a.poses == b.poses && a.points == b.points;
}
inline bool operator!=(const MapState& a, const MapState& b) { return !(a == b); }

/// Poses from an array of x, y [m], yaw [rad] each.
inline std::vector<Pose2> PosesOf(const std::vector<double>& poses) {
  std::vector<Pose2> unpacked;
  unpacked.reserve(poses.size() / 3);
  for (std::size_t i = 0; i < poses.size(); i += 3) unpacked.emplace_back(&poses[i]);
  return unpacked;
}

/// The inverse of PosesOf.
inline std::vector<double> PoseArray(const std::vector<Pose2>& poses) {
  std::vector<double> packed;
  packed.reserve(3 * poses.size());
  for (const Pose2& pose : poses) packed.insert(packed.end(), {pose.x, pose.y, pose.yaw});
  return packed;
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MAP_STATE_H_
