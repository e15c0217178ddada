#ifndef PLUMBLINE_APPS_IO_ROSBAG_READER_H_
#define PLUMBLINE_APPS_IO_ROSBAG_READER_H_

#include <string>

#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Which topics of a bag to read.
struct RosbagReadOptions {
  /// Of type sensor_msgs/LaserScan; empty: the only one of that type.
  std::string scan_topic;
  /// Of type nav_msgs/Odometry, or a topic of transforms to take the odometry from; empty: the only
  /// nav_msgs/Odometry, or the transforms if there is none.
  std::string odom_topic;
  /// The frame that the odometry moves in, to look for in the transforms.
  std::string odom_frame = RosRecording().odom_frame;

  bool Check(std::string* error) const {
    if (odom_frame.empty() && error != nullptr) *error = "odom_frame is empty";
    return !odom_frame.empty();
  }
};

/// Whether this build reads bags: it does where the library for them was found.
bool CanReadRosbags();

/// Reads scans, odometry and transforms from a bag of ROS 1, compressed or not. Transforms are all
/// messages of type tf2_msgs/TFMessage or tf/tfMessage.
///
/// InvalidArgument, listing what is there, if a topic is not, or is not of the type wanted, or has
/// to be chosen; and, naming topic, message (from 0), time and field, on poses or transforms that
/// are none (a number that is not finite, a quaternion whose norm is off by more than 1 %).
/// DataLoss on a bag that is cut off, has no index, or is corrupt; NotFound or Unavailable if the
/// file cannot be read. InvalidArgument, saying how to build it in, unless CanReadRosbags().
/// Replaces *recording on success only.
Status ReadRosbag(const std::string& path, const RosbagReadOptions& options,
                  RosRecording* recording);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROSBAG_READER_H_
