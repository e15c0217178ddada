// Stands in for the messages that ROS 2 generates: the fields that the node and its test use.
#ifndef PLUMBLINE_TEST_APPS_ROS2_STAND_IN_MESSAGES_HPP_
#define PLUMBLINE_TEST_APPS_ROS2_STAND_IN_MESSAGES_HPP_

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace builtin_interfaces::msg {
struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
}  // namespace builtin_interfaces::msg

namespace std_msgs::msg {
struct Header {
  builtin_interfaces::msg::Time stamp;
  std::string frame_id;
};
}  // namespace std_msgs::msg

namespace geometry_msgs::msg {
struct Point {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Quaternion {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};
struct Pose {
  Point position;
  Quaternion orientation;
};
struct PoseStamped {
  std_msgs::msg::Header header;
  Pose pose;
};
struct PoseWithCovariance {
  Pose pose;
  std::array<double, 36> covariance{};
};
struct PoseWithCovarianceStamped {
  std_msgs::msg::Header header;
  PoseWithCovariance pose;
};
struct Transform {
  Vector3 translation;
  Quaternion rotation;
};
struct TransformStamped {
  std_msgs::msg::Header header;
  std::string child_frame_id;
  Transform transform;
};
}  // namespace geometry_msgs::msg

namespace tf2_msgs::msg {
struct TFMessage {
  std::vector<geometry_msgs::msg::TransformStamped> transforms;
};
}  // namespace tf2_msgs::msg

namespace sensor_msgs::msg {
struct LaserScan {
  std_msgs::msg::Header header;
  float angle_min = 0.0F, angle_max = 0.0F, angle_increment = 0.0F;
  float time_increment = 0.0F, scan_time = 0.0F;
  float range_min = 0.0F, range_max = 0.0F;
  std::vector<float> ranges, intensities;
};
}  // namespace sensor_msgs::msg

namespace nav_msgs::msg {
struct Odometry {
  std_msgs::msg::Header header;
  std::string child_frame_id;
  geometry_msgs::msg::PoseWithCovariance pose;
};
struct Path {
  std_msgs::msg::Header header;
  std::vector<geometry_msgs::msg::PoseStamped> poses;
};
struct MapMetaData {
  builtin_interfaces::msg::Time map_load_time;
  float resolution = 0.0F;
  std::uint32_t width = 0, height = 0;
  geometry_msgs::msg::Pose origin;
};
struct OccupancyGrid {
  std_msgs::msg::Header header;
  MapMetaData info;
  std::vector<std::int8_t> data;
};
}  // namespace nav_msgs::msg

namespace diagnostic_msgs::msg {
struct KeyValue {
  std::string key, value;
};
struct DiagnosticStatus {
  unsigned char level = 0;
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
};
struct DiagnosticArray {
  std_msgs::msg::Header header;
  std::vector<DiagnosticStatus> status;
};
}  // namespace diagnostic_msgs::msg

namespace diagnostic_msgs::srv {
struct AddDiagnostics {
  struct Request {
    std::string load_namespace;
  };
  struct Response {
    bool success = false;
    std::string message;
  };
};
}  // namespace diagnostic_msgs::srv

namespace std_srvs::srv {
struct Trigger {
  struct Request {};
  struct Response {
    bool success = false;
    std::string message;
  };
};
struct SetBool {
  struct Request {
    bool data = false;
  };
  struct Response {
    bool success = false;
    std::string message;
  };
};
}  // namespace std_srvs::srv

#endif  // PLUMBLINE_TEST_APPS_ROS2_STAND_IN_MESSAGES_HPP_
