#include "plumbline/apps/ros2/mapper_node.h"

#include <chrono>
#include <diagnostic_msgs/srv/add_diagnostics.hpp>
#include <exception>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <std_srvs/srv/set_bool.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <utility>

#include "plumbline/apps/ros2/ros_messages.h"

namespace plumbline {
namespace {

constexpr char kNodeName[] = "plumbline";

// How often diagnostics are published.
constexpr std::chrono::seconds kDiagnosticPeriod(1);

// Depths of the queues of sensor data, of transforms as in tf2_ros, and of other topics.
constexpr std::size_t kSensorDepth = 50, kTransformDepth = 100, kDefaultDepth = 10;

}  // namespace

MapperNode::MapperNode(const rclcpp::NodeOptions& options)
    : rclcpp_lifecycle::LifecycleNode(kNodeName, options) {
  DeclareNodeParameters(this);
}

MapperNode::~MapperNode() { Release(); }

MapperNode::CallbackReturn MapperNode::on_configure(const rclcpp_lifecycle::State& /*previous*/) {
  Status status = ReadNodeParameters(*this, &parameters_);
  if (status.ok()) {
    session_ = std::make_unique<LiveSession>(parameters_.session, Outputs());
    status = session_->UseSavedMap();
  }
  if (!status.ok()) {
    RCLCPP_ERROR(get_logger(), "%s", status.message().c_str());
    Release();
    return CallbackReturn::FAILURE;
  }
  CreatePublishers();
  Subscribe();
  Serve();
  return CallbackReturn::SUCCESS;
}

MapperNode::CallbackReturn MapperNode::on_activate(const rclcpp_lifecycle::State& /*previous*/) {
  ForEachPublisher([](const auto& publisher) { publisher->on_activate(); });
  session_->Start();
  timer_ = create_wall_timer(kDiagnosticPeriod, [this] { session_->Report(); });
  is_active_ = true;
  return CallbackReturn::SUCCESS;
}

MapperNode::CallbackReturn MapperNode::on_deactivate(const rclcpp_lifecycle::State& /*previous*/) {
  is_active_ = false;
  timer_.reset();
  session_->Stop();
  ForEachPublisher([](const auto& publisher) { publisher->on_deactivate(); });
  return CallbackReturn::SUCCESS;
}

MapperNode::CallbackReturn MapperNode::on_cleanup(const rclcpp_lifecycle::State& /*previous*/) {
  Release();
  return CallbackReturn::SUCCESS;
}

MapperNode::CallbackReturn MapperNode::on_shutdown(const rclcpp_lifecycle::State& /*previous*/) {
  Release();
  return CallbackReturn::SUCCESS;
}

MapperNode::CallbackReturn MapperNode::on_error(const rclcpp_lifecycle::State& /*previous*/) {
  Release();
  return CallbackReturn::SUCCESS;
}

LiveOutputs MapperNode::Outputs() {
  LiveOutputs outputs;
  outputs.update = [this](const LiveUpdate& update) {
    TrySending([&] {
      tf_->publish(ToTransformMessage(update.stamp_s + parameters_.transform_timeout_s,
                                      parameters_.map_frame, update.child_frame,
                                      update.map_from_child));
      pose_->publish(ToPoseMessage(update.stamp_s, parameters_.map_frame, update.map_from_base));
    });
  };
  outputs.map = [this](const LiveMap& map) {
    TrySending([&] {
      map_->publish(ToGridMessage(map, parameters_.map_frame));
      path_->publish(ToPathMessage(map, parameters_.map_frame));
    });
  };
  outputs.diagnostic = [this](const Diagnostic& diagnostic) {
    TrySending([&] { diagnostics_->publish(ToDiagnosticMessage(now(), diagnostic)); });
  };
  outputs.news = [this](const std::string& line) { RCLCPP_WARN(get_logger(), "%s", line.c_str()); };
  return outputs;
}

void MapperNode::CreatePublishers() {
  const rclcpp::QoS latched = rclcpp::QoS(1).transient_local();
  tf_ = create_publisher<tf2_msgs::msg::TFMessage>("/tf", rclcpp::QoS(kTransformDepth));
  map_ = create_publisher<nav_msgs::msg::OccupancyGrid>("map", latched);
  path_ = create_publisher<nav_msgs::msg::Path>("plumbline/path", latched);
  pose_ = create_publisher<geometry_msgs::msg::PoseWithCovarianceStamped>(
      "pose", rclcpp::QoS(kDefaultDepth));
  diagnostics_ = create_publisher<diagnostic_msgs::msg::DiagnosticArray>(
      "/diagnostics", rclcpp::QoS(kDefaultDepth));
}

void MapperNode::Subscribe() {
  const rclcpp::QoS sensor = rclcpp::SensorDataQoS().keep_last(kSensorDepth);
  auto take_transforms = [this](const tf2_msgs::msg::TFMessage& message) {
    TakeTransforms(message);
  };
  subscriptions_.push_back(create_subscription<tf2_msgs::msg::TFMessage>(
      "/tf_static", rclcpp::QoS(kTransformDepth).transient_local(), take_transforms));
  subscriptions_.push_back(create_subscription<tf2_msgs::msg::TFMessage>(
      "/tf", rclcpp::QoS(kTransformDepth), take_transforms));
  if (!parameters_.odom_topic.empty()) {
    subscriptions_.push_back(create_subscription<nav_msgs::msg::Odometry>(
        parameters_.odom_topic, sensor, [this](const nav_msgs::msg::Odometry& message) {
          session_->node().AddOdometry(FromMessage(message));
          session_->Wake();
        }));
  }
  subscriptions_.push_back(create_subscription<sensor_msgs::msg::LaserScan>(
      parameters_.scan_topic, sensor, [this](const sensor_msgs::msg::LaserScan& message) {
        if (!is_active_) return;
        session_->node().AddScan(FromMessage(message), LiveSession::NowS());
        session_->Wake();
      }));
}

void MapperNode::TakeTransforms(const tf2_msgs::msg::TFMessage& message) {
  session_->node().AddTransforms(FromMessage(message));
  session_->Wake();
}

void MapperNode::Serve() {
  using diagnostic_msgs::srv::AddDiagnostics;
  using std_srvs::srv::SetBool;
  using std_srvs::srv::Trigger;
  const auto with_text = [](const AddDiagnostics::Request& request) {
    return LiveCommand{{}, request.load_namespace, false};
  };
  Serve<AddDiagnostics>("save_map", with_text);
  Serve<AddDiagnostics>("localize", with_text);
  Serve<Trigger>("clear", [](const Trigger::Request&) { return LiveCommand(); });
  Serve<SetBool>("pause", [](const SetBool::Request& request) {
    return LiveCommand{{}, {}, request.data};
  });
}

template <typename Service, typename ToCommand>
void MapperNode::Serve(const std::string& name, const ToCommand& to_command) {
  // The types of the arguments tell rclcpp that the response comes later.
  auto take = [this, name, to_command](std::shared_ptr<rclcpp::Service<Service>> service,
                                       std::shared_ptr<rmw_request_id_t> id,
                                       std::shared_ptr<typename Service::Request> request) {
    LiveCommand command = to_command(*request);
    command.name = name;
    session_->Execute(std::move(command),
                      [this, name, service, id](const Status& status, const std::string& text) {
                        RCLCPP_INFO(get_logger(), "%s: %s", name.c_str(), text.c_str());
                        typename Service::Response response;
                        response.success = status.ok();
                        response.message = text;
                        TrySending([&] { service->send_response(*id, response); });
                      });
  };
  services_.push_back(create_service<Service>("plumbline/" + name, take));
}

template <typename Action>
void MapperNode::ForEachPublisher(const Action& action) {
  action(tf_);
  action(map_);
  action(path_);
  action(pose_);
  action(diagnostics_);
}

template <typename Send>
void MapperNode::TrySending(const Send& send) {
  try {
    send();
  } catch (const std::exception& error) {
    session_->node().AddFault("messages that could not be sent", error.what());
  }
}

void MapperNode::Release() {
  is_active_ = false;
  timer_.reset();
  subscriptions_.clear();
  if (session_ != nullptr) session_->Stop();  // answers the services' requests
  services_.clear();
  tf_.reset();
  map_.reset();
  path_.reset();
  pose_.reset();
  diagnostics_.reset();
  session_.reset();
}

}  // namespace plumbline

RCLCPP_COMPONENTS_REGISTER_NODE(plumbline::MapperNode)
