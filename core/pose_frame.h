#ifndef PLUMBLINE_CORE_POSE_FRAME_H_
#define PLUMBLINE_CORE_POSE_FRAME_H_

#include <Eigen/Core>
#include <cmath>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// A pose with its rotation at hand.
struct PoseFrame {
  double x = 0.0, y = 0.0;
  double c = 1.0, s = 0.0;

  PoseFrame() = default;
  explicit PoseFrame(const double* pose)
      : x(pose[0]), y(pose[1]), c(std::cos(pose[2])), s(std::sin(pose[2])) {}
  explicit PoseFrame(const Pose2& pose)
      : x(pose.x), y(pose.y), c(std::cos(pose.yaw)), s(std::sin(pose.yaw)) {}

  /// From the robot's axes to those of the world.
  Eigen::Vector2d Rotate(const Eigen::Vector2d& v) const {
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
  }
  Eigen::Vector2d RotateBack(const Eigen::Vector2d& v) const {
    return {c * v.x() + s * v.y(), -s * v.x() + c * v.y()};
  }
  Eigen::Vector2d translation() const { return {x, y}; }
};

/// A vector turned by a right angle, counter-clockwise.
inline Eigen::Vector2d TurnedLeft(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_POSE_FRAME_H_
