#ifndef PLUMBLINE_APPS_ROS2_MAPPER_NODE_H_
#define PLUMBLINE_APPS_ROS2_MAPPER_NODE_H_

#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <memory>
#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/path.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <string>
#include <tf2_msgs/msg/tf_message.hpp>
#include <vector>

#include "plumbline/apps/live/live_session.h"
#include "plumbline/apps/ros2/node_parameters.h"

namespace plumbline {

/// The shell of a LiveSession on rclcpp: a managed node, and a component. Its topics, parameters
/// and services are in the README.
///
/// Configuring reads the parameters and the saved map, and subscribes. An active node maps. An
/// inactive one keeps the map and leaves scans out. Cleaning up forgets the map. All callbacks are
/// in the default group, which runs one at a time; they only hand messages and commands on.
class MapperNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  explicit MapperNode(const rclcpp::NodeOptions& options);
  ~MapperNode() override;
  MapperNode(const MapperNode&) = delete;
  MapperNode& operator=(const MapperNode&) = delete;

  CallbackReturn on_configure(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_activate(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_deactivate(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_cleanup(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_shutdown(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_error(const rclcpp_lifecycle::State& previous) override;

 private:
  template <typename Message>
  using Publisher = typename rclcpp_lifecycle::LifecyclePublisher<Message>::SharedPtr;

  LiveOutputs Outputs();
  void CreatePublishers();
  void Subscribe();
  void Serve();
  // to_command: from a request to a command without a name.
  template <typename Service, typename ToCommand>
  void Serve(const std::string& name, const ToCommand& to_command);
  void TakeTransforms(const tf2_msgs::msg::TFMessage& message);
  template <typename Action>
  void ForEachPublisher(const Action& action);
  // Calls what may throw; counts a fault if it does.
  template <typename Send>
  void TrySending(const Send& send);
  void Release();

  NodeParameters parameters_;
  bool is_active_ = false;
  Publisher<tf2_msgs::msg::TFMessage> tf_;
  Publisher<nav_msgs::msg::OccupancyGrid> map_;
  Publisher<nav_msgs::msg::Path> path_;
  Publisher<geometry_msgs::msg::PoseWithCovarianceStamped> pose_;
  Publisher<diagnostic_msgs::msg::DiagnosticArray> diagnostics_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::unique_ptr<LiveSession> session_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_ROS2_MAPPER_NODE_H_
