#include "plumbline/apps/ros2/ros_messages.h"

#include <algorithm>
#include <cmath>

#include "plumbline/apps/live/ros_values.h"

namespace plumbline {
namespace {

double StampOf(const std_msgs::msg::Header& header) {
  return ToSeconds({header.stamp.sec, header.stamp.nanosec});
}

std_msgs::msg::Header ToHeader(double stamp_s, const std::string& frame) {
  const RosTime time = ToRosTime(stamp_s);
  std_msgs::msg::Header header;
  header.stamp.sec = time.sec;
  header.stamp.nanosec = time.nanosec;
  header.frame_id = frame;
  return header;
}

template <typename Position>
RosPose FromPose(const Position& position, const geometry_msgs::msg::Quaternion& rotation) {
  return {{position.x, position.y, position.z},
          Eigen::Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z)};
}

geometry_msgs::msg::Quaternion ToQuaternion(double yaw_rad) {
  geometry_msgs::msg::Quaternion rotation;
  rotation.x = rotation.y = 0.0;
  rotation.z = std::sin(0.5 * yaw_rad);
  rotation.w = std::cos(0.5 * yaw_rad);
  return rotation;
}

geometry_msgs::msg::Pose ToPose(const Pose2& pose) {
  geometry_msgs::msg::Pose result;
  result.position.x = pose.x;
  result.position.y = pose.y;
  result.orientation = ToQuaternion(pose.yaw);
  return result;
}

}  // namespace

RosScan FromMessage(const sensor_msgs::msg::LaserScan& message) {
  RosScan scan;
  scan.stamp_s = StampOf(message.header);
  scan.frame = message.header.frame_id;
  scan.angle_min_rad = message.angle_min;
  scan.angle_max_rad = message.angle_max;
  scan.angle_increment_rad = message.angle_increment;
  scan.time_increment_s = message.time_increment;
  scan.range_min_m = message.range_min;
  scan.range_max_m = message.range_max;
  scan.ranges.assign(message.ranges.begin(), message.ranges.end());
  return scan;
}

RosOdometry FromMessage(const nav_msgs::msg::Odometry& message) {
  const geometry_msgs::msg::Pose& pose = message.pose.pose;
  return {StampOf(message.header), message.header.frame_id, message.child_frame_id,
          FromPose(pose.position, pose.orientation)};
}

std::vector<RosTransform> FromMessage(const tf2_msgs::msg::TFMessage& message) {
  std::vector<RosTransform> transforms;
  for (const geometry_msgs::msg::TransformStamped& stamped : message.transforms) {
    transforms.push_back({StampOf(stamped.header), stamped.header.frame_id, stamped.child_frame_id,
                          FromPose(stamped.transform.translation, stamped.transform.rotation)});
  }
  return transforms;
}

nav_msgs::msg::OccupancyGrid ToGridMessage(const LiveMap& map, const std::string& frame) {
  nav_msgs::msg::OccupancyGrid message;
  message.header = ToHeader(map.stamp_s, frame);
  message.info.map_load_time = message.header.stamp;
  message.info.resolution = static_cast<float>(map.grid.resolution_m);
  message.info.width = static_cast<std::uint32_t>(map.grid.width);
  message.info.height = static_cast<std::uint32_t>(map.grid.height);
  message.info.origin = ToPose({map.grid.left_m, map.grid.bottom_m, 0.0});
  message.data.resize(map.grid.cells.size());
  std::transform(map.grid.cells.begin(), map.grid.cells.end(), message.data.begin(), ToRosCell);
  return message;
}

nav_msgs::msg::Path ToPathMessage(const LiveMap& map, const std::string& frame) {
  nav_msgs::msg::Path message;
  message.header = ToHeader(map.stamp_s, frame);
  for (const TimedPose& pose : map.path) {
    geometry_msgs::msg::PoseStamped stamped;
    stamped.header = ToHeader(pose.timestamp_s, frame);
    stamped.pose = ToPose(pose.world_from_robot);
    message.poses.push_back(stamped);
  }
  return message;
}

geometry_msgs::msg::PoseWithCovarianceStamped ToPoseMessage(double stamp_s,
                                                            const std::string& frame,
                                                            const Pose2& map_from_base) {
  geometry_msgs::msg::PoseWithCovarianceStamped message;
  message.header = ToHeader(stamp_s, frame);
  message.pose.pose = ToPose(map_from_base);
  message.pose.covariance = RosPoseCovariance();
  return message;
}

tf2_msgs::msg::TFMessage ToTransformMessage(double stamp_s, const std::string& parent,
                                            const std::string& child,
                                            const Pose2& parent_from_child) {
  geometry_msgs::msg::TransformStamped stamped;
  stamped.header = ToHeader(stamp_s, parent);
  stamped.child_frame_id = child;
  stamped.transform.translation.x = parent_from_child.x;
  stamped.transform.translation.y = parent_from_child.y;
  stamped.transform.rotation = ToQuaternion(parent_from_child.yaw);
  tf2_msgs::msg::TFMessage message;
  message.transforms.push_back(stamped);
  return message;
}

diagnostic_msgs::msg::DiagnosticArray ToDiagnosticMessage(
    const builtin_interfaces::msg::Time& stamp, const Diagnostic& diagnostic) {
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level = static_cast<unsigned char>(diagnostic.level);
  status.name = diagnostic.name;
  status.message = diagnostic.message;
  for (const auto& [key, value] : diagnostic.values) {
    diagnostic_msgs::msg::KeyValue entry;
    entry.key = key;
    entry.value = value;
    status.values.push_back(entry);
  }
  diagnostic_msgs::msg::DiagnosticArray message;
  message.header.stamp = stamp;
  message.status.push_back(status);
  return message;
}

}  // namespace plumbline
