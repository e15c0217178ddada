// The node of the installed component, driven by the messages of a simulated robot.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <mutex>
#include <rclcpp_components/register_node_macro.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/apps/live/live_session.h"
#include "plumbline/apps/live/ros_values.h"
#include "plumbline/test/apps/live/simulated_robot.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using diagnostic_msgs::srv::AddDiagnostics;
using rclcpp::Parameter;
using std_srvs::srv::SetBool;
using std_srvs::srv::Trigger;
using testing::HasSubstr;

constexpr int kNumScans = 40;

const SimulatedRobot& Robot() {
  static const SimulatedRobot robot;
  return robot;
}

// Waits up to a minute.
bool WaitFor(const std::function<bool()>& condition) {
  for (int i = 0; i < 6000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

// A class and its library by the index of ament.
stand_in::NodeFactory LoadComponent() {
  const std::string prefix = std::getenv("AMENT_PREFIX_PATH");
  std::ifstream resource(prefix +
                         "/share/ament_index/resource_index/rclcpp_components/plumbline_ros");
  std::string name, library;
  std::getline(resource, name, ';');
  std::getline(resource, library);
  if (dlopen((prefix + "/" + library).c_str(), RTLD_NOW) == nullptr) {
    ADD_FAILURE() << dlerror();
    return nullptr;
  }
  return stand_in::NodeFactories().at(name);
}

template <typename Message>
class Inbox {
 public:
  explicit Inbox(const std::string& topic, const rclcpp::QoS& qos = 10)
      : subscription_(std::make_shared<stand_in::Receiver>(
            stand_in::Receiver{topic, typeid(Message), qos, [this](const void* message) {
                                 const std::lock_guard<std::mutex> lock(mutex_);
                                 messages_.push_back(*static_cast<const Message*>(message));
                               }})) {
    stand_in::Bus::Instance().Add(subscription_);
  }
  std::vector<Message> All() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }
  std::size_t size() const { return All().size(); }

 private:
  mutable std::mutex mutex_;
  std::vector<Message> messages_;
  std::shared_ptr<stand_in::Receiver> subscription_;
};

std_msgs::msg::Header HeaderOf(double stamp_s, const std::string& frame) {
  const RosTime time = ToRosTime(stamp_s);
  return {{time.sec, time.nanosec}, frame};
}

double StampOf(const std_msgs::msg::Header& header) {
  return ToSeconds({header.stamp.sec, header.stamp.nanosec});
}

tf2_msgs::msg::TFMessage MessageOf(const std::vector<RosTransform>& transforms) {
  tf2_msgs::msg::TFMessage message;
  for (const RosTransform& given : transforms) {
    const RosPose& pose = given.pose;
    message.transforms.push_back(
        {HeaderOf(given.stamp_s, given.frame),
         given.child_frame,
         {{pose.position.x(), pose.position.y(), pose.position.z()},
          {pose.rotation.x(), pose.rotation.y(), pose.rotation.z(), pose.rotation.w()}}});
  }
  return message;
}

sensor_msgs::msg::LaserScan MessageOf(const RosScan& scan) {
  sensor_msgs::msg::LaserScan message;
  message.header = HeaderOf(scan.stamp_s, scan.frame);
  message.angle_min = static_cast<float>(scan.angle_min_rad);
  message.angle_max = static_cast<float>(scan.angle_max_rad);
  message.angle_increment = static_cast<float>(scan.angle_increment_rad);
  message.range_min = static_cast<float>(scan.range_min_m);
  message.range_max = static_cast<float>(scan.range_max_m);
  message.ranges.assign(scan.ranges.begin(), scan.ranges.end());
  return message;
}

class MapperNodeTest : public testing::Test {
 protected:
  MapperNodeTest() {
    stand_in::Bus::Instance().Send("/tf_static", rclcpp::QoS(100).transient_local(),
                                   MessageOf(Robot().StaticTransforms()));
  }

  void Make(std::vector<Parameter> parameters) {
    static const stand_in::NodeFactory factory = LoadComponent();
    parameters.emplace_back("base_frame", "base_link");
    parameters.emplace_back("wait_for_background", true);
    node_ = factory(rclcpp::NodeOptions().parameter_overrides(parameters));
  }
  void Start() {
    ASSERT_EQ(node_->configure().label(), "inactive");
    ASSERT_EQ(node_->activate().label(), "active");
  }
  void SendScan(int i) {
    stand_in::Bus& bus = stand_in::Bus::Instance();
    bus.Send("/tf", rclcpp::QoS(100), MessageOf(Robot().OdometryTransform(i)));
    bus.Send("/scan", rclcpp::SensorDataQoS(), MessageOf(Robot().Scan(i)));
  }
  // Sends scans and waits for the pose of each.
  void Drive(int first, int last) {
    for (int i = first; i < last; ++i) {
      const std::size_t num_poses = poses_.size();
      SendScan(i);
      ASSERT_TRUE(WaitFor([&] { return poses_.size() > num_poses; })) << i;
    }
  }
  diagnostic_msgs::msg::DiagnosticStatus Diagnose() {
    stand_in::Bus::Instance().FireTimers();
    const auto all = diagnostics_.All();
    return all.empty() ? diagnostic_msgs::msg::DiagnosticStatus() : all.back().status.front();
  }
  std::string State() { return Diagnose().message; }
  std::string Value(const std::string& key) {
    for (const auto& value : Diagnose().values) {
      if (value.key == key) return value.value;
    }
    return "";
  }
  template <typename Service>
  typename Service::Response Ask(const std::string& name,
                                 const typename Service::Request& request) {
    std::mutex mutex;
    bool is_answered = false;
    typename Service::Response answer;
    const rclcpp::Call<Service> call{std::make_shared<typename Service::Request>(request),
                                     [&](const typename Service::Response& response) {
                                       const std::lock_guard<std::mutex> lock(mutex);
                                       answer = response;
                                       is_answered = true;
                                     }};
    EXPECT_TRUE(stand_in::Bus::Instance().Send("/plumbline/" + name, 10, call));
    EXPECT_TRUE(WaitFor([&] {
      const std::lock_guard<std::mutex> lock(mutex);
      return is_answered;
    }));
    const std::lock_guard<std::mutex> lock(mutex);
    return answer;
  }

  Inbox<tf2_msgs::msg::TFMessage> tf_{"/tf"};
  Inbox<geometry_msgs::msg::PoseWithCovarianceStamped> poses_{"/pose"};
  Inbox<diagnostic_msgs::msg::DiagnosticArray> diagnostics_{"/diagnostics"};
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_;
};

// What a LiveNode gives for the same messages.
struct Expected {
  std::vector<LiveUpdate> updates;
  LiveMap map;
};

Expected ExpectedDrive() {
  LiveOptions options;
  options.wait_for_background = true;
  LiveNode node(options);
  Expected expected;
  node.AddTransforms(Robot().StaticTransforms());
  for (int i = 0; i < kNumScans; ++i) {
    node.AddTransforms(Robot().OdometryTransform(i));
    node.AddScan(Robot().Scan(i), 5.0);
    node.Work(5.0, &expected.updates);
  }
  EXPECT_TRUE(node.BuildMap(&expected.map).ok());
  return expected;
}

void ExpectPose(const geometry_msgs::msg::Pose& pose, const Pose2& expected) {
  EXPECT_EQ(pose.position.x, expected.x);
  EXPECT_EQ(pose.position.y, expected.y);
  EXPECT_EQ(pose.orientation.z, std::sin(0.5 * expected.yaw));
  EXPECT_EQ(pose.orientation.w, std::cos(0.5 * expected.yaw));
}

TEST_F(MapperNodeTest, MapsLikeTheLiveNode) {
  Make({{"map_update_interval", 0.05}});
  ASSERT_NO_FATAL_FAILURE(Start());
  ASSERT_NO_FATAL_FAILURE(Drive(0, kNumScans));
  const Expected expected = ExpectedDrive();
  const auto poses = poses_.All();
  ASSERT_EQ(poses.size(), expected.updates.size());
  std::vector<geometry_msgs::msg::TransformStamped> corrections;
  for (const auto& message : tf_.All()) {
    for (const auto& stamped : message.transforms) {
      if (stamped.header.frame_id == "map") corrections.push_back(stamped);
    }
  }
  ASSERT_EQ(corrections.size(), poses.size());
  for (int i = 0; i < kNumScans; ++i) {
    SCOPED_TRACE(i);
    const LiveUpdate& update = expected.updates[i];
    EXPECT_EQ(poses[i].header.frame_id, "map");
    EXPECT_NEAR(StampOf(poses[i].header), update.stamp_s, 1e-6);
    ExpectPose(poses[i].pose.pose, update.map_from_base);
    EXPECT_EQ(poses[i].pose.covariance, RosPoseCovariance());
    EXPECT_EQ(corrections[i].child_frame_id, "odom");
    EXPECT_NEAR(StampOf(corrections[i].header), update.stamp_s + 0.2, 1e-6);
    EXPECT_EQ(corrections[i].transform.translation.x, update.map_from_child.x);
    EXPECT_EQ(corrections[i].transform.translation.y, update.map_from_child.y);
  }
}

TEST_F(MapperNodeTest, PublishesTheMapForLateSubscribers) {
  Make({{"map_update_interval", 0.05}});
  ASSERT_NO_FATAL_FAILURE(Start());
  ASSERT_NO_FATAL_FAILURE(Drive(0, kNumScans));
  const Expected expected = ExpectedDrive();
  const auto newest = [&] {
    const Inbox<nav_msgs::msg::OccupancyGrid> maps("/map", rclcpp::QoS(1).transient_local());
    return maps.size() == 0 ? nav_msgs::msg::OccupancyGrid() : maps.All().front();
  };
  ASSERT_TRUE(WaitFor([&] { return StampOf(newest().header) > expected.map.stamp_s - 1e-6; }));
  node_->deactivate();
  const nav_msgs::msg::OccupancyGrid map = newest();
  const OccupancyGrid& grid = expected.map.grid;
  EXPECT_EQ(map.header.frame_id, "map");
  EXPECT_EQ(map.info.resolution, 0.05F);
  EXPECT_EQ(map.info.width, static_cast<std::uint32_t>(grid.width));
  EXPECT_EQ(map.info.height, static_cast<std::uint32_t>(grid.height));
  ExpectPose(map.info.origin, {grid.left_m, grid.bottom_m, 0.0});
  std::vector<std::int8_t> cells;
  for (const Occupancy cell : grid.cells) cells.push_back(ToRosCell(cell));
  EXPECT_EQ(map.data, cells);
  EXPECT_THAT(std::set<int>(cells.begin(), cells.end()), testing::ElementsAre(-1, 0, 100));

  const Inbox<nav_msgs::msg::Path> paths("/plumbline/path", rclcpp::QoS(1).transient_local());
  ASSERT_EQ(paths.size(), 1u);
  const nav_msgs::msg::Path path = paths.All().front();
  ASSERT_EQ(path.poses.size(), expected.map.path.size());
  ExpectPose(path.poses.back().pose, expected.map.path.back().world_from_robot);
}

TEST_F(MapperNodeTest, MapsOnlyWhileItIsActive) {
  Make({});
  ASSERT_EQ(node_->configure().label(), "inactive");
  SendScan(0);
  ASSERT_EQ(node_->activate().label(), "active");
  EXPECT_EQ(State(), "waiting for scans");
  ASSERT_NO_FATAL_FAILURE(Drive(1, 3));
  EXPECT_EQ(State(), "mapping");
  EXPECT_EQ(node_->deactivate().label(), "inactive");
  const auto refused = Ask<Trigger>("clear", {});
  EXPECT_FALSE(refused.success);
  EXPECT_EQ(refused.message, "mapping has not been started");
  SendScan(3);
  // The map is kept.
  EXPECT_EQ(node_->activate().label(), "active");
  ASSERT_NO_FATAL_FAILURE(Drive(4, 6));
  EXPECT_EQ(Value("scans mapped"), "4");
  // It is forgotten.
  node_->deactivate();
  EXPECT_EQ(node_->cleanup().label(), "unconfigured");
  ASSERT_NO_FATAL_FAILURE(Start());
  EXPECT_EQ(State(), "waiting for scans");
  EXPECT_EQ(node_->shutdown().label(), "finalized");
  EXPECT_FALSE(stand_in::Bus::Instance().Send("/scan", 10, MessageOf(Robot().Scan(0))));
}

TEST_F(MapperNodeTest, AnswersServices) {
  const std::string folder = fs::path(testing::TempDir()) / "ros2_package_map";
  fs::remove_all(folder);
  Make({});
  ASSERT_NO_FATAL_FAILURE(Start());
  const auto too_early = Ask<AddDiagnostics>("save_map", {folder});
  EXPECT_FALSE(too_early.success);
  EXPECT_EQ(too_early.message, "there are no scans yet");
  ASSERT_NO_FATAL_FAILURE(Drive(0, 25));
  EXPECT_EQ(Ask<SetBool>("pause", {true}).message, "paused");
  SendScan(25);
  EXPECT_EQ(State(), "paused");
  EXPECT_TRUE(Ask<SetBool>("pause", {false}).success);
  EXPECT_EQ(Value("scans mapped"), "25");

  const auto saved = Ask<AddDiagnostics>("save_map", {folder});
  EXPECT_TRUE(saved.success) << saved.message;
  for (const char* file : {"map.yaml", "map.pgm", "map.g2o", "report.html"}) {
    EXPECT_TRUE(fs::exists(fs::path(folder) / file)) << file;
  }
  const auto missing = Ask<AddDiagnostics>("localize", {folder + "/none.g2o"});
  EXPECT_FALSE(missing.success);
  EXPECT_THAT(missing.message, HasSubstr("none.g2o"));
  EXPECT_TRUE(Ask<AddDiagnostics>("localize", {folder + "/map.g2o"}).success);
  SendScan(26);
  EXPECT_TRUE(WaitFor([&] { return State() == "looking for its place in the saved map"; }));
  EXPECT_TRUE(Ask<Trigger>("clear", {}).success);
  ASSERT_NO_FATAL_FAILURE(Drive(27, 28));
  EXPECT_EQ(State(), "mapping");

  // A node that begins in the saved map.
  node_->shutdown();
  Make({{"mode", "localization"}, {"map_file_name", folder + "/map.g2o"}});
  ASSERT_NO_FATAL_FAILURE(Start());
  SendScan(0);
  EXPECT_TRUE(WaitFor([&] { return State() == "looking for its place in the saved map"; }));
  fs::remove_all(folder);
}

TEST_F(MapperNodeTest, TellsOdometryAndFrames) {
  Make({{"odom_topic", "odometry"}, {"map_frame", "world"}, {"scan_topic", "/front/scan"}});
  ASSERT_NO_FATAL_FAILURE(Start());
  for (int i = 0; i < 3; ++i) {
    const RosOdometry given = Robot().Odometry(i);
    nav_msgs::msg::Odometry odometry;
    odometry.header = HeaderOf(given.stamp_s, "wheels");
    odometry.child_frame_id = given.child_frame;
    odometry.pose.pose.position = {given.pose.position.x(), given.pose.position.y(), 0.0};
    odometry.pose.pose.orientation = {0.0, 0.0, given.pose.rotation.z(), given.pose.rotation.w()};
    stand_in::Bus::Instance().Send("/odometry", rclcpp::QoS(10), odometry);
    stand_in::Bus::Instance().Send("/front/scan", rclcpp::QoS(10), MessageOf(Robot().Scan(i)));
    ASSERT_TRUE(WaitFor([&] { return poses_.size() == i + 1u; }));
  }
  EXPECT_EQ(poses_.All().back().header.frame_id, "world");
  const auto stamped = tf_.All().back().transforms.front();
  EXPECT_EQ(stamped.header.frame_id, "world");
  EXPECT_EQ(stamped.child_frame_id, "wheels");
}

TEST_F(MapperNodeTest, CountsFaults) {
  Make({});
  ASSERT_NO_FATAL_FAILURE(Start());
  EXPECT_EQ(Diagnose().level, 0);
  stand_in::Bus::Instance().Send("/scan", rclcpp::QoS(10), sensor_msgs::msg::LaserScan());
  EXPECT_EQ(Diagnose().level, 1);
  EXPECT_EQ(diagnostics_.All().back().header.stamp.sec,
            node_->now().operator builtin_interfaces::msg::Time().sec);
}

TEST_F(MapperNodeTest, RefusesParametersOutOfRange) {
  const std::vector<Parameter> wrong = {{"resolution", 0.0},         {"map_update_interval", 0.0},
                                        {"transform_timeout", -1.0}, {"mode", "lifelong"},
                                        {"mode", "localization"},    {"scan_topic", ""},
                                        {"map_file_name", "no.g2o"}, {"odom_frame", ""}};
  for (const Parameter& parameter : wrong) {
    SCOPED_TRACE(parameter.get_name());
    Make({parameter});
    EXPECT_EQ(node_->configure().label(), "unconfigured");
  }
  // As `ros2 param set`, and configured again.
  node_->set_parameter({"odom_frame", "odom"});
  EXPECT_EQ(node_->configure().label(), "inactive");
  EXPECT_ANY_THROW(Make({{"resolution", "fine"}}));
}

// The file for users has every parameter.
TEST_F(MapperNodeTest, ConfigurationHasAllParameters) {
  std::ifstream file(std::getenv("PLUMBLINE_ROS_CONFIG"));
  int num_parameters = 0;
  Make({});
  for (std::string line; std::getline(file, line);) {
    const std::size_t begin = line.find_first_not_of(' '), colon = line.find(':');
    if (begin != 4 || colon == line.npos) continue;
    ++num_parameters;
    EXPECT_NO_THROW(node_->get_parameter(line.substr(begin, colon - begin))) << line;
  }
  EXPECT_EQ(num_parameters, 11);
}

}  // namespace
}  // namespace plumbline
