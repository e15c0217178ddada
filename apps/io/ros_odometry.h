#ifndef PLUMBLINE_APPS_IO_ROS_ODOMETRY_H_
#define PLUMBLINE_APPS_IO_ROS_ODOMETRY_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/io/ros_clock.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// The robot of a recording and its odometry.
struct RosRobot {
  std::string frame;          ///< which the odometry moves
  std::string odometry_name;  ///< for errors: a topic or a transform
  /// Poses in the frame of the odometry; empty without odometry, or if it never changes.
  std::vector<TimedPose> odometry;
  StreamTimes times;  ///< of the poses; their stamps are in order if transforms tell the odometry
  std::vector<Warning> warnings;  ///< without the path
};

/// Finds the robot of a recording, see BuildGraph. InvalidArgument, without the path, if the
/// odometry that was asked for is not there, more of it is bad than BadRecordLimits allow, or the
/// transforms are ambiguous.
Status FindRobot(const RosRecording& recording, const std::string& laser_frame, RosRobot* robot);

/// The poses of scans by the odometry.
struct ScanPlaces {
  /// odom_from_robot per scan; empty for a scan to be skipped.
  std::vector<std::optional<Pose2>> poses;
  std::vector<char>
      is_held;               ///< per scan, whether it keeps the pose of the message nearest in time
  std::size_t num_far = 0;   ///< scans between messages more than max_gap_s apart
  std::size_t num_held = 0;  ///< scans of is_held
  std::size_t num_skipped = 0;
};

/// Places scans at their times [s], see BuildGraph: at the origin if there is no odometry.
ScanPlaces PlaceByOdometry(const std::vector<TimedPose>& odometry,
                           const std::vector<double>& times_s, double max_gap_s);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROS_ODOMETRY_H_
