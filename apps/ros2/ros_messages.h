#ifndef PLUMBLINE_APPS_ROS2_ROS_MESSAGES_H_
#define PLUMBLINE_APPS_ROS2_ROS_MESSAGES_H_

#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <nav_msgs/msg/path.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <string>
#include <tf2_msgs/msg/tf_message.hpp>
#include <vector>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/live/diagnostic.h"
#include "plumbline/apps/live/live_map.h"
#include "plumbline/core/pose2.h"

namespace plumbline {

/// The fields of messages of rclcpp, as the live node takes them.
RosScan FromMessage(const sensor_msgs::msg::LaserScan& message);
RosOdometry FromMessage(const nav_msgs::msg::Odometry& message);
std::vector<RosTransform> FromMessage(const tf2_msgs::msg::TFMessage& message);

/// Messages of rclcpp. frame: of the map; stamp_s: [s].
nav_msgs::msg::OccupancyGrid ToGridMessage(const LiveMap& map, const std::string& frame);
nav_msgs::msg::Path ToPathMessage(const LiveMap& map, const std::string& frame);
geometry_msgs::msg::PoseWithCovarianceStamped ToPoseMessage(double stamp_s,
                                                            const std::string& frame,
                                                            const Pose2& map_from_base);
/// One transform.
tf2_msgs::msg::TFMessage ToTransformMessage(double stamp_s, const std::string& parent,
                                            const std::string& child,
                                            const Pose2& parent_from_child);
/// One status.
diagnostic_msgs::msg::DiagnosticArray ToDiagnosticMessage(
    const builtin_interfaces::msg::Time& stamp, const Diagnostic& diagnostic);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_ROS2_ROS_MESSAGES_H_
