#ifndef PLUMBLINE_CORE_ROTATE_AXES_H_
#define PLUMBLINE_CORE_ROTATE_AXES_H_

#include <Eigen/Core>
#include <cmath>

namespace plumbline {

/// A covariance or information matrix (x, y, yaw) given in axes b, expressed in axes a.
inline Eigen::Matrix3d RotateAxes(const Eigen::Matrix3d& in_b, double a_from_b_yaw_rad) {
  const double c = std::cos(a_from_b_yaw_rad), s = std::sin(a_from_b_yaw_rad);
  Eigen::Matrix3d rotation;
  rotation << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return rotation * in_b * rotation.transpose();
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_ROTATE_AXES_H_
