#ifndef PLUMBLINE_APPS_BAGS_BAG_READER_H_
#define PLUMBLINE_APPS_BAGS_BAG_READER_H_

#include <optional>
#include <string>

#include "plumbline/apps/bags/cloud_cutter.h"
#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Which topics of a bag to read.
struct BagReadOptions {
  /// Of type sensor_msgs/LaserScan, MultiEchoLaserScan or PointCloud2; empty: the only one of the
  /// first of these types that the bag has.
  std::string scan_topic;
  RosEcho echo = RosEcho::kFirst;  ///< of the beams of a MultiEchoLaserScan
  /// The points of a PointCloud2 that make a scan; empty: all, which have to be at one height.
  std::optional<HeightBand> slice_height_m;
  /// Of type nav_msgs/Odometry, or a topic of transforms to take the odometry from; empty: the only
  /// nav_msgs/Odometry, or the transforms if there is none.
  std::string odom_topic;
  /// The frame that the odometry moves in, to look for in the transforms.
  std::string odom_frame = RosRecording().odom_frame;
  /// A bag without odometry is an error: where somebody asked for one. A topic asks as well.
  bool needs_odometry = RosRecording().needs_odometry;
  /// Memory that the messages may take [bytes], or a compressed file; 0: no limit.
  double max_bytes = 0.0;

  bool Check(std::string* error) const;
};

/// Reads scans, odometry and transforms from a bag of ROS 1 or ROS 2, see OpenBag. Transforms are
/// all messages of type tf2_msgs/TFMessage or tf/tfMessage. The types of ROS 2,
/// sensor_msgs/msg/LaserScan and so on, are the same as those of ROS 1.
///
/// InvalidArgument, listing what is there, if a topic is not, or is not of the type wanted, or has
/// to be chosen, or its messages have another encoding than those of ROS; and, naming topic,
/// message (from 0), time and field, on the message that takes more memory than allowed. Fails like
/// OpenBag and BagContainer. Replaces *recording on success only.
///
/// Messages that are none of their type, and poses and transforms that are none (a number that is
/// not finite, a quaternion whose norm is off by more than 1 %), are kept as faults of the
/// recording: BuildGraph judges the needed ones. A topic without messages does not count where
/// another one that could take its place has some.
Status ReadBag(const std::string& path, const BagReadOptions& options, RosRecording* recording);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_BAG_READER_H_
