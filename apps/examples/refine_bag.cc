// Maps a ROS bag in a program of one's own: reads scans and odometry with rosbag, finds a starting
// point (scan matching, loop closure, pose graph), estimates all poses and all laser returns
// together, and writes the trajectory (TUM: t x y z qx qy qz qw). For bags as they come, with
// transforms, several lasers or lasers upside down, take plumbline_slam, which reads them, too.
// Here is the skeleton for those who want their own topics and their own use of the result.
//
//   plumbline_example_refine_bag IN.bag SCAN_TOPIC ODOM_TOPIC OUT.tum
#include <nav_msgs/Odometry.h>
#include <plumbline/core/map_state.h>
#include <plumbline/core/slam_graph.h>
#include <plumbline/solvers/map_log.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

using plumbline::Pose2;
using plumbline::Status;

namespace {

// Where the laser sits on the robot: x, y [m], yaw [rad].
const Pose2 kRobotFromLaser(0.0, 0.0, 0.0);
constexpr double kMaxGap_s = 0.5;  // between the odometry before and after a scan

// Poses of the robot in the frame of its odometry, by time [s].
using Odometry = std::map<double, Pose2>;

// Straight from the sample before to the one after. False without both.
bool PoseAt(const Odometry& odometry, double time_s, Pose2* pose) {
  const auto after = odometry.lower_bound(time_s);
  if (after == odometry.end()) return false;
  *pose = after->second;
  if (after->first == time_s) return true;
  if (after == odometry.begin()) return false;
  const auto before = std::prev(after);
  const double gap_s = after->first - before->first;
  if (gap_s > kMaxGap_s) return false;
  const double share = (time_s - before->first) / gap_s;
  const Pose2 motion = Between(before->second, after->second);
  *pose = before->second * Pose2(share * motion.x, share * motion.y, share * motion.yaw);
  return true;
}

Odometry ReadOdometry(const rosbag::Bag& bag, const std::string& topic) {
  Odometry odometry;
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& instance : view) {
    const auto message = instance.instantiate<nav_msgs::Odometry>();
    if (!message) continue;  // of another type
    const auto& position = message->pose.pose.position;
    const auto& q = message->pose.pose.orientation;
    odometry[message->header.stamp.toSec()] = {
        position.x, position.y,
        std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))};
  }
  return odometry;
}

// One pose per scan, and the odometry from each to the next. A sweep is taken as one instant.
Status AddScan(const sensor_msgs::LaserScan& message, const Pose2& odom_from_robot,
               Pose2* last_odom_from_robot, plumbline::SlamGraph* graph) {
  plumbline::LaserModel laser;
  laser.num_beams = static_cast<int>(message.ranges.size());
  laser.first_bearing_rad = message.angle_min;
  laser.bearing_step_rad = message.angle_increment;
  laser.min_range_m = std::max<double>(laser.min_range_m, message.range_min);
  laser.max_range_m = message.range_max;
  laser.robot_from_laser = kRobotFromLaser;
  int laser_id = 0, pose = 0;
  PLUMBLINE_RETURN_IF_ERROR(graph->AddLaser(laser, &laser_id));
  PLUMBLINE_RETURN_IF_ERROR(graph->AddPose(odom_from_robot, message.header.stamp.toSec(), &pose));
  PLUMBLINE_RETURN_IF_ERROR(
      graph->AddScan(pose, laser_id, {message.ranges.begin(), message.ranges.end()}));
  if (pose > 0) {
    PLUMBLINE_RETURN_IF_ERROR(
        graph->AddOdometry({pose - 1, pose, Between(*last_odom_from_robot, odom_from_robot)}));
  }
  *last_odom_from_robot = odom_from_robot;
  return Status::Ok();
}

Status ReadBag(const std::string& path, const std::string& scan_topic,
               const std::string& odom_topic, plumbline::SlamGraph* graph) {
  const rosbag::Bag bag(path);
  const Odometry odometry = ReadOdometry(bag, odom_topic);
  rosbag::View view(bag, rosbag::TopicQuery(scan_topic));
  int num_scans = 0;
  Pose2 last;
  for (const rosbag::MessageInstance& instance : view) {
    const auto message = instance.instantiate<sensor_msgs::LaserScan>();
    if (!message) continue;
    ++num_scans;
    Pose2 pose;
    if (!PoseAt(odometry, message->header.stamp.toSec(), &pose)) continue;
    PLUMBLINE_RETURN_IF_ERROR(AddScan(*message, pose, &last, graph));
  }
  std::printf("%s: %d scans, %d of them with odometry, %zu returns\n", path.c_str(), num_scans,
              graph->num_scans(), graph->num_returns());
  if (graph->num_returns() > 0) return Status::Ok();
  return Status::InvalidArgument(path + ": no scan on " + scan_topic + " has odometry on " +
                                 odom_topic);
}

Status Map(const plumbline::SlamGraph& graph, plumbline::MapState* state) {
  plumbline::LogMapping mapping;
  PLUMBLINE_RETURN_IF_ERROR(
      plumbline::MapLog(plumbline::MapLogOptions(), graph, nullptr, &mapping));
  std::fputs(plumbline::AlarmText(mapping.report.alarms).c_str(), stderr);
  std::printf("%s\n", mapping.report.solver.BriefReport().c_str());
  *state = std::move(mapping.state);
  return Status::Ok();
}

Status WriteTrajectory(const std::string& path, const plumbline::SlamGraph& graph,
                       const plumbline::MapState& state) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  bool good = file != nullptr;
  for (int i = 0; good && i < state.num_poses(); ++i) {
    const Pose2 pose = state.WorldFromRobot(i);
    good = std::fprintf(file, "%.6f %.9f %.9f 0 0 0 %.9f %.9f\n", graph.timestamp_s(i), pose.x,
                        pose.y, std::sin(0.5 * pose.yaw), std::cos(0.5 * pose.yaw)) > 0;
  }
  if (file != nullptr) good &= std::fclose(file) == 0;
  return good ? Status::Ok() : Status::Unavailable("cannot write " + path);
}

Status Run(char** arguments) {
  plumbline::SlamGraph graph;
  PLUMBLINE_RETURN_IF_ERROR(ReadBag(arguments[1], arguments[2], arguments[3], &graph));
  plumbline::MapState state;
  PLUMBLINE_RETURN_IF_ERROR(Map(graph, &state));
  return WriteTrajectory(arguments[4], graph, state);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s IN.bag SCAN_TOPIC ODOM_TOPIC OUT.tum\n", argv[0]);
    return 1;
  }
  try {
    const Status status = Run(argv);
    if (!status.ok()) std::fprintf(stderr, "%s\n", status.message().c_str());
    return status.ok() ? 0 : 1;
  } catch (const std::exception& exception) {  // rosbag, on a bag that it cannot read
    std::fprintf(stderr, "%s: %s\n", argv[1], exception.what());
    return 1;
  }
}
