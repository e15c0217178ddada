#ifndef PLUMBLINE_FACTORS_RELATIVE_POSE_FACTOR_H_
#define PLUMBLINE_FACTORS_RELATIVE_POSE_FACTOR_H_

#include <Eigen/Core>
#include <cmath>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/factors/analytic_factor_forward.h"

namespace plumbline {

/// A measured pose of b as seen from a, (t_ab, yaw_ab) = a_from_b:
///   e = [ R(yaw_a)^T (t_b - t_a) - t_ab ; wrap(yaw_b - yaw_a - yaw_ab) ],
///   residual = U e,   U^T U = Sigma^-1.
/// Blocks: world_from_a (3), world_from_b (3), each x, y [m], yaw [rad]. Residual: 3,
/// dimensionless. Sigma is given in the frame of a, order x, y [m], yaw [rad]. The residual jumps
/// where the yaw error crosses +-pi; the derivatives are exact everywhere else, also far from zero
/// error. Source: Lu, Milios: Globally consistent range scan alignment (1997).
struct RelativePoseResidual {
  Pose2 a_from_b;                                                  ///< as measured
  Eigen::Matrix3d sqrt_information = Eigen::Matrix3d::Identity();  ///< U

  /// d_a, d_b: 3x3 row-major or null. Returns false on poses that are not finite.
  bool Evaluate(const double* world_from_a, const double* world_from_b, double* residuals,
                double* d_a, double* d_b) const {
    using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const double c = std::cos(world_from_a[2]), s = std::sin(world_from_a[2]);
    const double dx = world_from_b[0] - world_from_a[0], dy = world_from_b[1] - world_from_a[1];
    const double x_in_a = c * dx + s * dy, y_in_a = -s * dx + c * dy;
    const Eigen::Vector3d error(x_in_a - a_from_b.x, y_in_a - a_from_b.y,
                                NormalizeAngle(world_from_b[2] - world_from_a[2] - a_from_b.yaw));
    Eigen::Map<Eigen::Vector3d> residual(residuals);
    residual = sqrt_information * error;
    Eigen::Matrix3d jacobian;
    if (d_a != nullptr) {
      jacobian << -c, -s, y_in_a, s, -c, -x_in_a, 0.0, 0.0, -1.0;
      Eigen::Map<RowMajor3d> whitened(d_a);
      whitened = sqrt_information * jacobian;
    }
    if (d_b != nullptr) {
      jacobian << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
      Eigen::Map<RowMajor3d> whitened(d_b);
      whitened = sqrt_information * jacobian;
    }
    return residual.allFinite();
  }
};

using RelativePoseFactor = AnalyticFactor<RelativePoseResidual, 3, 3, 3>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_RELATIVE_POSE_FACTOR_H_
