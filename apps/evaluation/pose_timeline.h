#ifndef PLUMBLINE_APPS_EVALUATION_POSE_TIMELINE_H_
#define PLUMBLINE_APPS_EVALUATION_POSE_TIMELINE_H_

#include <vector>

#include "plumbline/apps/io/trajectory_io.h"

namespace plumbline {

/// Times of one moment differ by less [s]: files keep six decimals or fewer, and no scanner is
/// faster than a scan per millisecond.
constexpr double kSameTime_s = 1e-3;

/// A trajectory in order of time, to look up poses in.
class PoseTimeline {
 public:
  /// Poses of equal time keep their order.
  explicit PoseTimeline(std::vector<TimedPose> trajectory);

  /// The pose nearest in time, of two equally near ones the earlier; null if it is more than
  /// tolerance_s [s] away.
  const TimedPose* Nearest(double timestamp_s, double tolerance_s) const;

  const std::vector<TimedPose>& poses() const { return poses_; }

 private:
  std::vector<TimedPose> poses_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_POSE_TIMELINE_H_
