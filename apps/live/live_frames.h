#ifndef PLUMBLINE_APPS_LIVE_LIVE_FRAMES_H_
#define PLUMBLINE_APPS_LIVE_LIVE_FRAMES_H_

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/io/ros_mounting.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/io/transform_tree.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// The pose of the robot by its odometry at the time of a scan.
struct OdometryAtTime {
  enum class State {
    kKnown,
    kTooEarly,  ///< no message of that time or later has come yet
    kUnknown,   ///< the messages before and after are missing or too far apart
  };
  State state = State::kUnknown;
  Pose2 odom_from_robot;  ///< if kKnown
};

/// The latest transforms of a robot, and its odometry of the last seconds. Its memory is bounded.
/// Frames have no leading slash.
class LiveFrames {
 public:
  /// odom_frame: frame in which the odometry moves the robot. by_messages: odometry messages tell
  /// it; otherwise the transforms from odom_frame do.
  LiveFrames(std::string odom_frame, bool by_messages);

  /// Takes a transform. InvalidArgument, without the frames, if it is none.
  Status AddTransform(const RosTransform& transform);

  /// Takes an odometry message, whose frames count from then on. InvalidArgument if it is none, or
  /// if transforms tell the odometry.
  Status AddOdometry(const RosOdometry& odometry);

  /// The frame that the odometry moves on the way to a laser; empty if it is not known.
  std::string RobotFrame(const std::string& laser_frame) const;

  /// The place of a laser on the robot by the latest transforms: at the robot's centre if
  /// `is_known` is false. Its faults have one entry.
  LaserPlaces PlaceOfLaser(const std::string& robot_frame, const std::string& laser_frame) const;

  /// The pose of one frame in another; empty if no transforms join them.
  std::optional<Pose2> Find(const std::string& target, const std::string& source) const;

  /// The pose of `robot_frame` in the odometry's frame, interpolated between two messages that are
  /// at most 0.5 s apart.
  OdometryAtTime OdometryAt(const std::string& robot_frame, double stamp_s) const;

  /// Forgets the odometry so far. A message that is older than the one before by more than 1 s has
  /// the same effect.
  void ForgetOdometry() { tracks_.clear(); }

  const std::string& odom_frame() const { return odom_frame_; }
  /// Number of poses that the odometry has given.
  std::size_t num_odometry_poses() const { return num_odometry_poses_; }

 private:
  struct Edge {
    std::string parent;
    Eigen::Isometry3d parent_from_child = Eigen::Isometry3d::Identity();
  };

  Status AddToTrack(const std::string& robot_frame, const TimedPose& pose);
  TransformTree Tree() const;

  std::string odom_frame_;
  const bool by_messages_;
  std::string message_child_;                            // of the odometry messages
  std::map<std::string, Edge> edges_;                    // by the lower frame
  std::map<std::string, std::deque<TimedPose>> tracks_;  // by the frame that the odometry moves
  std::size_t num_odometry_poses_ = 0;
};

/// The name of a frame or topic without its leading slash.
std::string WithoutLeadingSlash(const std::string& name);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_LIVE_FRAMES_H_
