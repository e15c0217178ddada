#ifndef PLUMBLINE_APPS_ROS2_NODE_PARAMETERS_H_
#define PLUMBLINE_APPS_ROS2_NODE_PARAMETERS_H_

#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>

#include "plumbline/apps/live/live_session.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// The parameters of the README.
struct NodeParameters {
  LiveSessionOptions session;
  std::string scan_topic = "scan";
  std::string odom_topic;  ///< empty: the transforms tell the odometry
  std::string map_frame = "map";
  double transform_timeout_s = 0.2;  ///< how long a transform stays valid after its scan [s]
};

/// Declares the parameters with their defaults. Throws like LifecycleNode::declare_parameter if an
/// override has another type.
void DeclareNodeParameters(rclcpp_lifecycle::LifecycleNode* node);

/// Reads the declared parameters. InvalidArgument, naming the parameter, if one is out of range.
Status ReadNodeParameters(const rclcpp_lifecycle::LifecycleNode& node, NodeParameters* parameters);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_ROS2_NODE_PARAMETERS_H_
