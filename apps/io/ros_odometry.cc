#include "plumbline/apps/io/ros_odometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/apps/io/ros_mounting.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

bool AreSame(const Pose2& a, const Pose2& b) { return a.x == b.x && a.y == b.y && a.yaw == b.yaw; }

// Poses that are all the same are no odometry.
bool NeverChanges(const std::vector<TimedPose>& poses) {
  return std::all_of(poses.begin(), poses.end(), [&](const TimedPose& pose) {
    return AreSame(pose.world_from_robot, poses.front().world_from_robot);
  });
}

// A message that was recorded several times counts once.
bool IsRepeated(const TimedPose& pose, const TimedPose& before) {
  return pose.timestamp_s == before.timestamp_s &&
         AreSame(pose.world_from_robot, before.world_from_robot);
}

void TakeOdometry(std::vector<TimedPose> poses, RosRobot* robot) {
  if (NeverChanges(poses)) {
    robot->times = {robot->times.topic, {}, {}};
  } else {
    robot->odometry = std::move(poses);
  }
}

void TakeMessages(const RosRecording& recording, RosRobot* robot) {
  std::vector<TimedPose> poses;
  const bool has_times = recording.odometry_received_s.size() == recording.odometry.size();
  for (std::size_t i = 0; i < recording.odometry.size(); ++i) {
    const TimedPose& pose = recording.odometry[i];
    if (!poses.empty() && IsRepeated(pose, poses.back())) continue;
    poses.push_back(pose);
    robot->times.stamps_s.push_back(pose.timestamp_s);
    if (has_times) robot->times.received_s.push_back(recording.odometry_received_s[i]);
  }
  robot->frame = recording.robot_frame;
  robot->odometry_name = robot->times.topic = recording.odom_topic;
  TakeOdometry(std::move(poses), robot);
}

void TakeTransforms(const RosRecording& recording, const std::string& robot_frame,
                    RosRobot* robot) {
  std::vector<TimedPose> poses;
  for (const StampedTransform& sample :
       recording.transforms.Samples(recording.odom_frame, robot_frame)) {
    const TimedPose pose{sample.stamp_s, InPlane(sample.parent_from_child)};
    if (!poses.empty() && IsRepeated(pose, poses.back())) continue;
    poses.push_back(pose);
    robot->times.stamps_s.push_back(sample.stamp_s);
    robot->times.received_s.push_back(sample.received_s);
  }
  std::sort(robot->times.received_s.begin(), robot->times.received_s.end());
  robot->frame = robot_frame;
  robot->odometry_name = "the transform of '" + robot_frame + "' in '" + recording.odom_frame + "'";
  robot->times.topic = robot->odometry_name;
  TakeOdometry(std::move(poses), robot);
}

bool IsAtRest(const std::vector<StampedTransform>& samples) {
  return std::all_of(samples.begin(), samples.end(), [&](const StampedTransform& sample) {
    return AreAtRest(InPlane(samples.front().parent_from_child), InPlane(sample.parent_from_child));
  });
}

// The frame that the odometry moves where no transform joins the laser with it; empty if several
// could be it.
std::string RobotApartFromLaser(const RosRecording& recording) {
  std::vector<std::string> moving;
  for (const std::string& child : recording.transforms.Children(recording.odom_frame)) {
    if (!IsAtRest(recording.transforms.Samples(recording.odom_frame, child))) {
      moving.push_back(child);
    }
  }
  for (const char* usual : {"base_footprint", "base_link"}) {
    if (std::find(moving.begin(), moving.end(), usual) != moving.end()) return usual;
  }
  return moving.size() == 1 ? moving.front() : "";
}

// The robot is as far up as nothing moves.
void GoWithoutOdometry(const RosRecording& recording, const std::string& laser_frame,
                       RosRobot* robot) {
  const std::vector<std::string> path = recording.transforms.PathToRoot(laser_frame);
  robot->frame = path.front();
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (!IsAtRest(recording.transforms.Samples(path[i], path[i - 1]))) {
      robot->warnings.push_back(
          {"unused_transforms", "the frame '" + robot->frame + "' moves in '" + path[i] +
                                    "': --odom_frame=" + path[i] + " takes that as odometry"});
      break;
    }
    robot->frame = path[i];
  }
}

// Largest share of scans without odometry that are skipped rather than matched without.
constexpr double kMaxSkippedShare = 0.02;

// The pose between two messages that are far apart; empty if the robot may have done anything.
std::optional<Pose2> InterpolateFar(const std::vector<TimedPose>& poses, std::size_t after,
                                    double time_s) {
  constexpr double kMaxGapS = 5.0, kMaxMoveM = 2.0, kMaxTurnRad = DegToRad(60.0);
  if (after == 0 || after == poses.size()) return std::nullopt;
  const Pose2 motion = Between(poses[after - 1].world_from_robot, poses[after].world_from_robot);
  if (motion.translation().norm() > kMaxMoveM ||
      std::abs(NormalizeAngle(motion.yaw)) > kMaxTurnRad) {
    return std::nullopt;
  }
  return PoseTimeline({poses[after - 1], poses[after]}).Interpolate(time_s, kMaxGapS);
}

void PlaceWithoutMessages(const std::vector<TimedPose>& poses, const std::vector<double>& times_s,
                          ScanPlaces* places) {
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (places->poses[i]) continue;
    const auto after = static_cast<std::size_t>(
        std::lower_bound(poses.begin(), poses.end(), times_s[i],
                         [](const TimedPose& pose, double t) { return pose.timestamp_s < t; }) -
        poses.begin());
    places->poses[i] = InterpolateFar(poses, after, times_s[i]);
    if (places->poses[i]) {
      ++places->num_far;
      continue;
    }
    const bool is_nearer_to_next =
        after == 0 || (after < poses.size() && poses[after].timestamp_s - times_s[i] <
                                                   times_s[i] - poses[after - 1].timestamp_s);
    places->poses[i] = poses[is_nearer_to_next ? after : after - 1].world_from_robot;
    places->is_held[i] = 1;
    ++places->num_held;
  }
}

}  // namespace

Status FindRobot(const RosRecording& recording, const std::string& laser_frame, RosRobot* robot) {
  const std::size_t num_bad = recording.bad_odometry.num();
  const std::size_t num_messages = num_bad + recording.odometry.size();
  if (num_bad > 0 && (num_bad > BadRecordLimits().Of(num_messages) || num_bad == num_messages)) {
    return Status::InvalidArgument(
        recording.bad_odometry.Text(num_messages, "messages on " + recording.odom_topic));
  }
  RosRobot result;
  if (!recording.odometry.empty()) {
    TakeMessages(recording, &result);
    *robot = std::move(result);
    return Status::Ok();
  }
  const bool wants_messages = recording.needs_odometry && !recording.odom_topic.empty();
  if (wants_messages) {
    return Status::InvalidArgument("there is no message on " + recording.odom_topic);
  }
  std::vector<std::string> path;
  PLUMBLINE_RETURN_IF_ERROR(recording.transforms.PathUp(laser_frame, recording.odom_frame, &path));
  const std::string robot_frame =
      path.size() > 1 ? path[path.size() - 2] : RobotApartFromLaser(recording);
  if (laser_frame != recording.odom_frame && !robot_frame.empty()) {
    TakeTransforms(recording, robot_frame, &result);
  } else if (recording.needs_odometry) {
    return Status::InvalidArgument(
        "there is no odometry: no nav_msgs/Odometry, and no frame '" + recording.odom_frame +
        "' above the laser's, '" + laser_frame +
        "', in the transforms; frames: " + recording.transforms.FrameNames());
  } else {
    GoWithoutOdometry(recording, laser_frame, &result);
  }
  *robot = std::move(result);
  return Status::Ok();
}

ScanPlaces PlaceByOdometry(const std::vector<TimedPose>& odometry,
                           const std::vector<double>& times_s, double max_gap_s) {
  ScanPlaces places;
  places.poses.resize(times_s.size(), Pose2());
  places.is_held.resize(times_s.size(), 0);
  if (odometry.empty()) return places;
  const PoseTimeline timeline(odometry);
  std::size_t num_missing = 0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    places.poses[i] = timeline.Interpolate(times_s[i], max_gap_s);
    if (!places.poses[i]) ++num_missing;
  }
  if (static_cast<double>(num_missing) <= kMaxSkippedShare * static_cast<double>(times_s.size())) {
    places.num_skipped = num_missing;
    return places;
  }
  PlaceWithoutMessages(timeline.poses(), times_s, &places);
  return places;
}

}  // namespace plumbline
