#include "plumbline/solvers/front_end/still_wheels.h"

#include <algorithm>
#include <cstddef>

namespace plumbline {
namespace {

// Length of the spans that are compared [m]: 100 times what a match is off by.
constexpr double kStillSpanM = 1.0;
// The wheels stand still if they report less than this share of the way over this number of
// consecutive spans. Outdoors, where little is near, a matching without odometry may jump by a few
// metres.
constexpr double kMaxReportedShare = 0.1;
constexpr std::size_t kMinStillSpans = 5;

// Keyframes first to last: where the robot was at the ends of a span.
struct StillSpan {
  std::size_t first, last;
  bool is_still;
};

double ReportedM(const std::vector<Pose2>& odometry, int from, int to) {
  Pose2 step;
  for (int pose = from + 1; pose <= to; ++pose) step = step * odometry[pose];
  return step.translation().norm();
}

std::vector<StillSpan> CompareSpans(const std::vector<Pose2>& odometry,
                                    const SequentialTrajectory& matched) {
  const std::vector<Keyframe>& keys = matched.keyframes;
  std::vector<StillSpan> spans;
  std::size_t first = 0;
  double driven_m = 0.0, reported_m = 0.0;
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const int from = keys[k - 1].pose, to = keys[k].pose;
    if (keys[k].after_unmatched) {  // not measured
      first = k;
      driven_m = reported_m = 0.0;
      continue;
    }
    reported_m += ReportedM(odometry, from, to);
    driven_m +=
        Between(matched.world_from_robot[from], matched.world_from_robot[to]).translation().norm();
    if (driven_m < kStillSpanM) continue;
    spans.push_back({first, k, reported_m < kMaxReportedShare * driven_m});
    first = k;
    driven_m = reported_m = 0.0;
  }
  return spans;
}

}  // namespace

std::vector<char> FindStillWheels(const std::vector<Pose2>& odometry,
                                  const SequentialTrajectory& matched) {
  std::vector<char> is_still(odometry.size(), 0);
  const std::vector<StillSpan> spans = CompareSpans(odometry, matched);
  for (std::size_t begin = 0; begin < spans.size();) {
    std::size_t end = begin;
    while (end < spans.size() && spans[end].is_still) ++end;
    if (end - begin >= kMinStillSpans) {
      // The spans beside these may be still in part.
      const std::size_t first = spans[begin > 0 ? begin - 1 : 0].first;
      const std::size_t last = spans[std::min(end, spans.size() - 1)].last;
      std::fill(is_still.begin() + matched.keyframes[first].pose + 1,
                is_still.begin() + matched.keyframes[last].pose + 1, 1);
    }
    begin = end + 1;
  }
  return is_still;
}

}  // namespace plumbline
