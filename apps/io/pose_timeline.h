#ifndef PLUMBLINE_APPS_IO_POSE_TIMELINE_H_
#define PLUMBLINE_APPS_IO_POSE_TIMELINE_H_

#include <optional>
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

  /// The pose at a time, from the one before to the one after at constant speed and turn rate.
  /// Empty if these are more than max_gap_s [s] apart, or one of them is missing.
  std::optional<Pose2> Interpolate(double timestamp_s, double max_gap_s) const;

  const std::vector<TimedPose>& poses() const { return poses_; }

 private:
  std::vector<TimedPose> poses_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_POSE_TIMELINE_H_
