#include "plumbline/apps/io/pose_timeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumbline {
namespace {

// A share of a motion at constant speed and turn rate: an arc, whose chord is turned by half of
// what is yet to be turned.
Pose2 ShareOf(const Pose2& motion, double share) {
  const double half = 0.5 * motion.yaw;
  const double length = std::abs(half) < 1e-6 ? share : std::sin(share * half) / std::sin(half);
  const Pose2 chord = Pose2(0.0, 0.0, (share - 1.0) * half) * Pose2(motion.x, motion.y, 0.0);
  return {length * chord.x, length * chord.y, share * motion.yaw};
}

}  // namespace

PoseTimeline::PoseTimeline(std::vector<TimedPose> trajectory) : poses_(std::move(trajectory)) {
  std::stable_sort(poses_.begin(), poses_.end(), [](const TimedPose& a, const TimedPose& b) {
    return a.timestamp_s < b.timestamp_s;
  });
}

const TimedPose* PoseTimeline::Nearest(double timestamp_s, double tolerance_s) const {
  const auto distance_s = [timestamp_s](const TimedPose& pose) {
    return std::abs(pose.timestamp_s - timestamp_s);
  };
  auto nearest =
      std::lower_bound(poses_.begin(), poses_.end(), timestamp_s,
                       [](const TimedPose& pose, double t) { return pose.timestamp_s < t; });
  if (nearest != poses_.begin() &&
      (nearest == poses_.end() || distance_s(*(nearest - 1)) <= distance_s(*nearest))) {
    --nearest;
  }
  if (nearest == poses_.end() || distance_s(*nearest) > tolerance_s) return nullptr;
  return &*nearest;
}

std::optional<Pose2> PoseTimeline::Interpolate(double timestamp_s, double max_gap_s) const {
  const auto after =
      std::lower_bound(poses_.begin(), poses_.end(), timestamp_s,
                       [](const TimedPose& pose, double t) { return pose.timestamp_s < t; });
  if (after == poses_.end()) return std::nullopt;
  if (after->timestamp_s == timestamp_s) return after->world_from_robot;
  if (after == poses_.begin()) return std::nullopt;
  const TimedPose& before = *(after - 1);
  const double gap_s = after->timestamp_s - before.timestamp_s;
  if (gap_s > max_gap_s) return std::nullopt;
  const Pose2 motion = Between(before.world_from_robot, after->world_from_robot);
  return before.world_from_robot * ShareOf(motion, (timestamp_s - before.timestamp_s) / gap_s);
}

}  // namespace plumbline
