#ifndef PLUMBLINE_CORE_POSE_FRAME_H_
#define PLUMBLINE_CORE_POSE_FRAME_H_

#include <Eigen/Core>
#include <cmath>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// A pose with its rotation at hand.
struct PoseFrame {
  double x = 0.0;  ///< of world_from_robot [m]
  double y = 0.0;  ///< likewise
  double c = 1.0;  ///< cosine of the yaw
  double s = 0.0;  ///< sine of the yaw

  PoseFrame() = default;
  /// @{
  /// Of a pose, or of x, y [m], yaw [rad].
  explicit PoseFrame(const double* pose)
      : x(pose[0]), y(pose[1]), c(std::cos(pose[2])), s(std::sin(pose[2])) {}
  explicit PoseFrame(const Pose2& pose)
      : x(pose.x), y(pose.y), c(std::cos(pose.yaw)), s(std::sin(pose.yaw)) {}
  /// @}

  /// From the robot's axes to those of the world.
  Eigen::Vector2d Rotate(const Eigen::Vector2d& v) const {
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
  }
  /// The inverse of Rotate.
  Eigen::Vector2d RotateBack(const Eigen::Vector2d& v) const {
    return {c * v.x() + s * v.y(), -s * v.x() + c * v.y()};
  }
  /// Where the robot is [m].
  Eigen::Vector2d translation() const { return {x, y}; }
  /// A point of the robot's frame in the world [m].
  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const {
    return Rotate(point) + translation();
  }
};

/// A vector turned by a right angle, counter-clockwise.
inline Eigen::Vector2d TurnedLeft(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

/// A vector turned by an angle [rad], counter-clockwise. Up to 0.05 rad, polynomials that are exact
/// to rounding take the place of sine and cosine.
inline Eigen::Vector2d Turned(const Eigen::Vector2d& v, double angle_rad) {
  const double squared = angle_rad * angle_rad;
  double c = 1.0 - squared * (1.0 / 2 - squared * (1.0 / 24 - squared * (1.0 / 720)));
  double s =
      angle_rad * (1.0 - squared * (1.0 / 6 - squared * (1.0 / 120 - squared * (1.0 / 5040))));
  if (squared > 0.05 * 0.05) {
    c = std::cos(angle_rad);
    s = std::sin(angle_rad);
  }
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_POSE_FRAME_H_
