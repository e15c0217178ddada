#include "plumbline/apps/ros2/node_parameters.h"

namespace plumbline {
namespace {

constexpr char kMapping[] = "mapping", kLocalization[] = "localization";

// base_frame of slam_toolbox.
constexpr char kBaseFrame[] = "base_footprint";

Status CheckWithin(const std::string& name, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return Status::Ok();
  return Status::InvalidArgument("parameter " + name + " = " + std::to_string(value) +
                                 " must be from " + std::to_string(lowest) + " to " +
                                 std::to_string(highest));
}

Status CheckMode(const std::string& mode, const std::string& map_file) {
  if (mode == kMapping) return Status::Ok();
  if (mode != kLocalization) {
    return Status::InvalidArgument("parameter mode: '" + mode +
                                   "' is neither mapping nor localization");
  }
  if (!map_file.empty()) return Status::Ok();
  return Status::InvalidArgument("parameter map_file_name: mode localization needs a saved map");
}

}  // namespace

void DeclareNodeParameters(rclcpp_lifecycle::LifecycleNode* node) {
  const NodeParameters defaults;
  node->declare_parameter("scan_topic", defaults.scan_topic);
  node->declare_parameter("odom_topic", defaults.odom_topic);
  node->declare_parameter("map_frame", defaults.map_frame);
  node->declare_parameter("odom_frame", defaults.session.node.odom_frame);
  node->declare_parameter("base_frame", std::string(kBaseFrame));
  node->declare_parameter("resolution", defaults.session.node.resolution_m);
  node->declare_parameter("map_update_interval", defaults.session.map_update_interval_s);
  node->declare_parameter("transform_timeout", defaults.transform_timeout_s);
  node->declare_parameter("mode", std::string(kMapping));
  node->declare_parameter("map_file_name", defaults.session.map_file);
  node->declare_parameter("wait_for_background", defaults.session.node.wait_for_background);
}

Status ReadNodeParameters(const rclcpp_lifecycle::LifecycleNode& node, NodeParameters* parameters) {
  const auto text = [&](const char* name) { return node.get_parameter(name).as_string(); };
  const auto number = [&](const char* name) { return node.get_parameter(name).as_double(); };
  NodeParameters result;
  LiveSessionOptions& session = result.session;
  result.scan_topic = text("scan_topic");
  result.odom_topic = text("odom_topic");
  result.map_frame = text("map_frame");
  session.node.odom_frame = text("odom_frame");
  session.node.base_frame = text("base_frame");
  session.node.odometry_by_messages = !result.odom_topic.empty();
  session.node.resolution_m = number("resolution");
  session.map_update_interval_s = number("map_update_interval");
  result.transform_timeout_s = number("transform_timeout");
  session.map_file = text("map_file_name");
  session.localize = text("mode") == kLocalization;
  session.node.wait_for_background = node.get_parameter("wait_for_background").as_bool();
  PLUMBLINE_RETURN_IF_ERROR(CheckMode(text("mode"), session.map_file));
  PLUMBLINE_RETURN_IF_ERROR(
      CheckWithin("transform_timeout", result.transform_timeout_s, 0.0, 10.0));
  for (const char* name : {"scan_topic", "map_frame"}) {
    if (text(name).empty()) {
      return Status::InvalidArgument("parameter " + std::string(name) + " is empty");
    }
  }
  std::string error;
  if (!session.Check(&error)) return Status::InvalidArgument("parameters: " + error);
  *parameters = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
