// Stands in for rclcpp_components: a library that is loaded tells how its node is made.
#ifndef PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_COMPONENTS_REGISTER_NODE_MACRO_HPP_
#define PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_COMPONENTS_REGISTER_NODE_MACRO_HPP_

#include <functional>
#include <map>
#include <memory>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>

namespace stand_in {

using NodeFactory =
    std::function<std::shared_ptr<rclcpp_lifecycle::LifecycleNode>(const rclcpp::NodeOptions&)>;

/// By the name of the class.
inline std::map<std::string, NodeFactory>& NodeFactories() {
  static std::map<std::string, NodeFactory> factories;
  return factories;
}

}  // namespace stand_in

#define RCLCPP_COMPONENTS_REGISTER_NODE(NodeClass)                                        \
  static const bool stand_in_is_registered =                                              \
      stand_in::NodeFactories()                                                           \
          .emplace(#NodeClass, [](const rclcpp::NodeOptions& options)                     \
                                   -> std::shared_ptr<rclcpp_lifecycle::LifecycleNode> {   \
            return std::make_shared<NodeClass>(options);                                  \
          })                                                                              \
          .second;

#endif  // PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_COMPONENTS_REGISTER_NODE_MACRO_HPP_
