// Stands in for rclcpp_lifecycle: states, publishers that are silent while the node is inactive, and
// the functions of a node.
#ifndef PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_LIFECYCLE_LIFECYCLE_NODE_HPP_
#define PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_LIFECYCLE_LIFECYCLE_NODE_HPP_

#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <string>
#include <utility>

namespace rclcpp_lifecycle {

class State {
 public:
  explicit State(std::string label = "unconfigured") : label_(std::move(label)) {}
  std::string label() const { return label_; }

 private:
  std::string label_;
};

namespace node_interfaces {

class LifecycleNodeInterface {
 public:
  enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };

  virtual ~LifecycleNodeInterface() = default;
  virtual CallbackReturn on_configure(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_shutdown(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_error(const State&) { return CallbackReturn::FAILURE; }
};

}  // namespace node_interfaces

template <typename MessageT>
class LifecyclePublisher {
 public:
  using SharedPtr = std::shared_ptr<LifecyclePublisher>;
  LifecyclePublisher(std::string name, const rclcpp::QoS& qos)
      : name_(std::move(name)), qos_(qos) {}
  virtual ~LifecyclePublisher() = default;
  virtual void on_activate() { is_active_ = true; }
  virtual void on_deactivate() { is_active_ = false; }
  virtual void publish(const MessageT& msg) {
    if (is_active_) stand_in::Bus::Instance().Send(name_, qos_, msg);
  }

 private:
  std::string name_;
  rclcpp::QoS qos_;
  std::atomic<bool> is_active_{false};
};

class LifecycleNode : public node_interfaces::LifecycleNodeInterface,
                      public std::enable_shared_from_this<LifecycleNode> {
 public:
  using SharedPtr = std::shared_ptr<LifecycleNode>;
  explicit LifecycleNode(const std::string& node_name,
                         const rclcpp::NodeOptions& options = rclcpp::NodeOptions())
      : name_(node_name), options_(options) {}

  rclcpp::Logger get_logger() const { return rclcpp::Logger(name_); }
  rclcpp::Time now() const { return rclcpp::Time(4711); }

  template <typename ParameterT>
  ParameterT declare_parameter(const std::string& name, const ParameterT& default_value) {
    rclcpp::ParameterVariant value = default_value;
    for (const rclcpp::Parameter& given : options_.parameter_overrides()) {
      if (given.get_name() != name) continue;
      if (given.variant().index() != value.index()) {
        throw std::runtime_error("parameter '" + name + "' has invalid type");
      }
      value = given.variant();
    }
    if (!parameters_.emplace(name, value).second) throw std::runtime_error(name + " is declared");
    return std::get<ParameterT>(value);
  }
  rclcpp::Parameter get_parameter(const std::string& name) const {
    return std::visit([&](const auto& value) { return MakeParameter(name, value); },
                      parameters_.at(name));
  }
  /// As `ros2 param set`.
  void set_parameter(const rclcpp::Parameter& parameter) {
    parameters_.at(parameter.get_name()) = parameter.variant();
  }

  template <typename MessageT>
  std::shared_ptr<LifecyclePublisher<MessageT>> create_publisher(const std::string& topic_name,
                                                                 const rclcpp::QoS& qos) {
    return std::make_shared<LifecyclePublisher<MessageT>>(stand_in::Bus::Absolute(topic_name), qos);
  }
  template <typename MessageT, typename CallbackT>
  std::shared_ptr<rclcpp::SubscriptionBase> create_subscription(const std::string& topic_name,
                                                                const rclcpp::QoS& qos,
                                                                CallbackT&& callback) {
    const auto subscription = std::make_shared<rclcpp::SubscriptionBase>(stand_in::Receiver{
        stand_in::Bus::Absolute(topic_name), typeid(MessageT), qos,
        [callback](const void* message) { callback(*static_cast<const MessageT*>(message)); }});
    stand_in::Bus::Instance().Add(subscription);
    return subscription;
  }
  template <typename ServiceT, typename CallbackT>
  std::shared_ptr<rclcpp::Service<ServiceT>> create_service(const std::string& service_name,
                                                            CallbackT&& callback) {
    return std::make_shared<rclcpp::Service<ServiceT>>(stand_in::Bus::Absolute(service_name),
                                                       std::forward<CallbackT>(callback));
  }
  template <typename DurationT, typename CallbackT>
  rclcpp::TimerBase::SharedPtr create_wall_timer(DurationT, CallbackT callback) {
    return std::make_shared<rclcpp::TimerBase>(callback);
  }

  const State& get_current_state() const { return state_; }
  const State& configure() { return Move("unconfigured", "inactive", &LifecycleNode::on_configure); }
  const State& activate() { return Move("inactive", "active", &LifecycleNode::on_activate); }
  const State& deactivate() { return Move("active", "inactive", &LifecycleNode::on_deactivate); }
  const State& cleanup() { return Move("inactive", "unconfigured", &LifecycleNode::on_cleanup); }
  const State& shutdown() { return Move(state_.label(), "finalized", &LifecycleNode::on_shutdown); }

 private:
  template <typename Value>
  static rclcpp::Parameter MakeParameter(const std::string& name, const Value& value) {
    if constexpr (std::is_same_v<Value, std::int64_t>) {
      return {name, static_cast<int>(value)};
    } else {
      return {name, value};
    }
  }

  // A transition that fails leaves the state; an error leads to on_error.
  const State& Move(const std::string& from, const std::string& to,
                    CallbackReturn (LifecycleNodeInterface::*callback)(const State&)) {
    if (state_.label() != from) return state_;
    CallbackReturn result = CallbackReturn::ERROR;
    try {
      result = (this->*callback)(state_);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "exception in a transition: %s\n", error.what());
    }
    if (result == CallbackReturn::SUCCESS) state_ = State(to);
    if (result == CallbackReturn::ERROR) {
      const bool is_handled = on_error(state_) == CallbackReturn::SUCCESS;
      state_ = State(is_handled ? "unconfigured" : "finalized");
    }
    return state_;
  }

  std::string name_;
  rclcpp::NodeOptions options_;
  std::map<std::string, rclcpp::ParameterVariant> parameters_;
  State state_;
};

}  // namespace rclcpp_lifecycle

#endif  // PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_LIFECYCLE_LIFECYCLE_NODE_HPP_
