#ifndef PLUMBLINE_APPS_BAGS_ROS_MESSAGE_H_
#define PLUMBLINE_APPS_BAGS_ROS_MESSAGE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/apps/io/ros_recording.h"

namespace plumbline {

/// How the bytes of a message hold its fields.
enum class RosEncoding {
  kRos1,  ///< one after the other, little-endian
  kCdr,   ///< of ROS 2: OMG's plain CDR (XCDR1), aligned, in the byte order that its header names
};

/// Of geometry_msgs/Pose or Transform, as it stands in the message: of any length.
struct RosPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// What a nav_msgs/Odometry says of the pose.
struct RosOdometry {
  double stamp_s = 0.0;
  std::string frame, child_frame;
  RosPose pose;
};

/// Converts a pose. False if a number is not finite or beyond input_limits.h, or the norm of the
/// quaternion is off by more than 1 %; `fault` then says why, as "is not finite".
bool ToIsometry(const RosPose& pose, Eigen::Isometry3d* transform, std::string* fault);

/// A geometry_msgs/TransformStamped.
struct RosTransform {
  double stamp_s = 0.0;
  std::string frame, child_frame;
  RosPose pose;  ///< frame_from_child
};

/// Which echo of a beam counts where there are several.
enum class RosEcho {
  kFirst,
  kStrongest,  ///< the one with the largest intensity
};

/// The returns of a sensor_msgs/PointCloud2: x, y, z [m] in its frame, of all points.
struct RosCloud {
  double stamp_s = 0.0;
  std::string frame;
  std::vector<Eigen::Vector3d> points;
};

// Each takes the bytes of one message. False if they are none of the type: `fault` then says why,
// as "field 'ranges': its 400 elements are more than the message holds", and the output is
// anything. Numbers are not looked at. Memory stays within a few times the bytes of the message.

/// A sensor_msgs/LaserScan.
bool DecodeScan(RosEncoding encoding, std::string_view bytes, RosScan* scan, std::string* fault);
/// A sensor_msgs/MultiEchoLaserScan, with one echo of each beam; infinity where there is none.
bool DecodeMultiEchoScan(RosEncoding encoding, std::string_view bytes, RosEcho echo, RosScan* scan,
                         std::string* fault);
/// A sensor_msgs/PointCloud2 with fields x, y and z of 4 or 8 bytes, in any byte order.
bool DecodeCloud(RosEncoding encoding, std::string_view bytes, RosCloud* cloud, std::string* fault);
/// A nav_msgs/Odometry.
bool DecodeOdometry(RosEncoding encoding, std::string_view bytes, RosOdometry* odometry,
                    std::string* fault);
/// A tf2_msgs/TFMessage.
bool DecodeTransforms(RosEncoding encoding, std::string_view bytes,
                      std::vector<RosTransform>* transforms, std::string* fault);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_ROS_MESSAGE_H_
