// Stands in for rclcpp_lifecycle, likewise.
#ifndef PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_RCLCPP_LIFECYCLE_LIFECYCLE_NODE_HPP_
#define PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_RCLCPP_LIFECYCLE_LIFECYCLE_NODE_HPP_

#include <memory>
#include <rclcpp/rclcpp.hpp>

namespace rclcpp_lifecycle {

class LifecycleNode : public rclcpp::Node {
 public:
  using SharedPtr = std::shared_ptr<LifecycleNode>;
};

}  // namespace rclcpp_lifecycle

#endif  // PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_RCLCPP_LIFECYCLE_LIFECYCLE_NODE_HPP_
