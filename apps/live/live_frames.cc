#include "plumbline/apps/live/live_frames.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/core/input_limits.h"

namespace plumbline {
namespace {

// Limits of memory: frames, frames right below the odometry's, and per such frame seconds and
// poses.
constexpr std::size_t kMaxFrames = 1000, kMaxTracks = 16, kMaxPoses = 5000;
constexpr double kTrackS = 20.0;
// An odometry message that is older than the last one by more than this begins a new track [s].
constexpr double kJumpBackS = 1.0;
// Largest gap of the odometry that is interpolated [s], as in BuildGraph.
constexpr double kMaxOdometryGapS = 0.5;

Status PoseStatus(const RosPose& pose, double stamp_s, Eigen::Isometry3d* transform) {
  std::string fault;
  if (!ToIsometry(pose, transform, &fault)) return Status::InvalidArgument("its pose " + fault);
  if (!std::isfinite(stamp_s) || std::abs(stamp_s) > kMaxTimeS) {
    return Status::InvalidArgument("field 'header.stamp' is no time");
  }
  return Status::Ok();
}

}  // namespace

std::string WithoutLeadingSlash(const std::string& name) {
  return name.empty() || name.front() != '/' ? name : name.substr(1);
}

LiveFrames::LiveFrames(std::string odom_frame, bool by_messages)
    : odom_frame_(std::move(odom_frame)), by_messages_(by_messages) {}

Status LiveFrames::AddTransform(const RosTransform& transform) {
  Eigen::Isometry3d parent_from_child;
  PLUMBLINE_RETURN_IF_ERROR(PoseStatus(transform.pose, transform.stamp_s, &parent_from_child));
  const std::string parent = WithoutLeadingSlash(transform.frame);
  const std::string child = WithoutLeadingSlash(transform.child_frame);
  if (parent.empty() || child.empty() || parent == child) {
    return Status::InvalidArgument("it joins '" + parent + "' and '" + child + "'");
  }
  if (edges_.count(child) == 0 && edges_.size() >= kMaxFrames) {
    return Status::InvalidArgument("there are more than " + std::to_string(kMaxFrames) + " frames");
  }
  edges_[child] = {parent, parent_from_child};
  if (by_messages_ || parent != odom_frame_) return Status::Ok();
  return AddToTrack(child, {transform.stamp_s, InPlane(parent_from_child)});
}

Status LiveFrames::AddOdometry(const RosOdometry& odometry) {
  if (!by_messages_) return Status::InvalidArgument("transforms tell the odometry");
  Eigen::Isometry3d odom_from_robot;
  PLUMBLINE_RETURN_IF_ERROR(PoseStatus(odometry.pose, odometry.stamp_s, &odom_from_robot));
  const std::string frame = WithoutLeadingSlash(odometry.frame);
  if (!frame.empty()) odom_frame_ = frame;
  message_child_ = WithoutLeadingSlash(odometry.child_frame);
  return AddToTrack(message_child_, {odometry.stamp_s, InPlane(odom_from_robot)});
}

Status LiveFrames::AddToTrack(const std::string& robot_frame, const TimedPose& pose) {
  if (tracks_.count(robot_frame) == 0 && tracks_.size() >= kMaxTracks) {
    return Status::InvalidArgument("the odometry moves more than " + std::to_string(kMaxTracks) +
                                   " frames");
  }
  std::deque<TimedPose>& track = tracks_[robot_frame];
  if (!track.empty() && pose.timestamp_s <= track.back().timestamp_s) {
    if (track.back().timestamp_s - pose.timestamp_s <= kJumpBackS) return Status::Ok();
    track.clear();
  }
  ++num_odometry_poses_;
  track.push_back(pose);
  while (track.size() > kMaxPoses || track.front().timestamp_s < pose.timestamp_s - kTrackS) {
    track.pop_front();
  }
  return Status::Ok();
}

TransformTree LiveFrames::Tree() const {
  TransformTree tree;
  for (const auto& [child, edge] : edges_) {
    tree.Add(edge.parent, child, {0.0, edge.parent_from_child, 0.0});
  }
  return tree;
}

std::string LiveFrames::RobotFrame(const std::string& laser_frame) const {
  if (by_messages_) return message_child_;
  // A frame has one parent here, so that a way up can neither fork nor fail.
  std::string frame = laser_frame;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto edge = edges_.find(frame);
    if (edge == edges_.end()) return "";
    if (edge->second.parent == odom_frame_) return frame;
    frame = edge->second.parent;
  }
  return "";
}

LaserPlaces LiveFrames::PlaceOfLaser(const std::string& robot_frame,
                                     const std::string& laser_frame) const {
  LaserPlaces places;
  if (robot_frame == laser_frame) {
    places.is_known = true;
    places.faults.resize(1);
    places.kinds.resize(1);
    return places;
  }
  // Frames that are above themselves join nothing.
  if (!FindLaserPlace(Tree(), robot_frame, laser_frame, {0.0}, &places).ok()) return LaserPlaces();
  return places;
}

std::optional<Pose2> LiveFrames::Find(const std::string& target, const std::string& source) const {
  if (target == source) return Pose2();
  const TransformTree tree = Tree();
  std::optional<TransformPath> path;
  if (!tree.FindPath(target, source, &path).ok() || !path) return std::nullopt;
  return InPlane(tree.At(*path, 0.0));
}

OdometryAtTime LiveFrames::OdometryAt(const std::string& robot_frame, double stamp_s) const {
  const auto found = tracks_.find(robot_frame);
  if (found == tracks_.end()) return {OdometryAtTime::State::kTooEarly, {}};
  const std::deque<TimedPose>& track = found->second;
  const auto after = std::lower_bound(
      track.begin(), track.end(), stamp_s,
      [](const TimedPose& pose, double time_s) { return pose.timestamp_s < time_s; });
  if (after == track.end()) return {OdometryAtTime::State::kTooEarly, {}};
  std::vector<TimedPose> around;
  if (after != track.begin()) around.push_back(*(after - 1));
  around.push_back(*after);
  const std::optional<Pose2> pose =
      PoseTimeline(std::move(around)).Interpolate(stamp_s, kMaxOdometryGapS);
  if (!pose) return {OdometryAtTime::State::kUnknown, {}};
  return {OdometryAtTime::State::kKnown, *pose};
}

}  // namespace plumbline
