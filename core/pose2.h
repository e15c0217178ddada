#ifndef PLUMBLINE_CORE_POSE2_H_
#define PLUMBLINE_CORE_POSE2_H_

#include <Eigen/Core>
#include <cmath>

#include "plumbline/core/angle.h"

namespace plumbline {

/// A rigid motion of the plane, read "a_from_b": it maps coordinates in frame b to frame a.
/// T is double or an automatic-differentiation scalar.
template <typename T>
struct SE2 {
  T x = T(0);    ///< [m]
  T y = T(0);    ///< [m]
  T yaw = T(0);  ///< [rad], unbounded; wrap on read-out.

  /// The identity.
  SE2() = default;
  /// x, y [m], yaw [rad].
  SE2(const T& x_in, const T& y_in, const T& yaw_in) : x(x_in), y(y_in), yaw(yaw_in) {}
  /// From a parameter block (x, y [m], yaw [rad]).
  explicit SE2(const T* block) : x(block[0]), y(block[1]), yaw(block[2]) {}

  /// x, y [m]: where the origin of b lies in a.
  Eigen::Matrix<T, 2, 1> translation() const { return {x, y}; }

  /// a_from_b * b_from_c = a_from_c. The yaw is the plain sum, not wrapped.
  SE2 operator*(const SE2& other) const {
    using std::cos;
    using std::sin;
    const T c = cos(yaw), s = sin(yaw);
    return {x + c * other.x - s * other.y, y + s * other.x + c * other.y, yaw + other.yaw};
  }

  /// Coordinates in frame a of a point given in frame b.
  Eigen::Matrix<T, 2, 1> operator*(const Eigen::Matrix<T, 2, 1>& point_in_b) const {
    using std::cos;
    using std::sin;
    const T c = cos(yaw), s = sin(yaw);
    return {x + c * point_in_b.x() - s * point_in_b.y(),
            y + s * point_in_b.x() + c * point_in_b.y()};
  }

  /// b_from_a.
  SE2 Inverse() const {
    using std::cos;
    using std::sin;
    const T c = cos(yaw), s = sin(yaw);
    return {-c * x - s * y, s * x - c * y, -yaw};
  }
};

/// A pose in plain numbers.
using Pose2 = SE2<double>;

/// a_from_b for two frames given in a common world; the yaw is wrapped to [-pi, pi).
template <typename T>
SE2<T> Between(const SE2<T>& world_from_a, const SE2<T>& world_from_b) {
  using std::cos;
  using std::sin;
  const T c = cos(world_from_a.yaw), s = sin(world_from_a.yaw);
  const T dx = world_from_b.x - world_from_a.x, dy = world_from_b.y - world_from_a.y;
  return {c * dx + s * dy, -s * dx + c * dy, NormalizeAngle(world_from_b.yaw - world_from_a.yaw)};
}

/// Whether no coordinate is NaN or infinite.
inline bool IsFinite(const Pose2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw);
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_POSE2_H_
