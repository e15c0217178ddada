#include "plumbline/apps/evaluation/pose_timeline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumbline {

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

}  // namespace plumbline
