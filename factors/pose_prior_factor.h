#ifndef PLUMBLINE_FACTORS_POSE_PRIOR_FACTOR_H_
#define PLUMBLINE_FACTORS_POSE_PRIOR_FACTOR_H_

#include <Eigen/Core>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/factors/analytic_factor.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// A pose known in advance, (x0, y0, yaw0):
///   e = [ x - x0 ; y - y0 ; wrap(yaw - yaw0) ],   residual = U e,   U^T U = Sigma^-1.
/// Block: world_from_robot (3: x, y [m], yaw [rad]). Residual: 3, dimensionless. Sigma is given in
/// the world frame, order x, y [m], yaw [rad]. The residual jumps where the yaw error crosses +-pi.
struct PosePriorResidual {
  Pose2 prior;  ///< world_from_robot
  Eigen::Matrix3d sqrt_information = Eigen::Matrix3d::Identity();

  /// d_pose: 3x3 row-major or null. Returns false on a pose that is not finite.
  bool Evaluate(const double* world_from_robot, double* residuals, double* d_pose) const {
    const Eigen::Vector3d error(world_from_robot[0] - prior.x, world_from_robot[1] - prior.y,
                                NormalizeAngle(world_from_robot[2] - prior.yaw));
    Eigen::Map<Eigen::Vector3d> residual(residuals);
    residual = sqrt_information * error;
    if (d_pose != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> jacobian(d_pose);
      jacobian = sqrt_information;
    }
    return residual.allFinite();
  }
};

inline PosePriorResidual MakePosePriorResidual(const Pose2& world_from_robot,
                                               const PosePriorOptions& options) {
  PosePriorResidual residual;
  residual.prior = world_from_robot;
  residual.sqrt_information =
      Eigen::Vector3d(options.sigma_translation_m, options.sigma_translation_m,
                      options.sigma_rotation_rad)
          .cwiseInverse()
          .asDiagonal();
  return residual;
}

using PosePriorFactor = AnalyticFactor<PosePriorResidual, 3, 3>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_POSE_PRIOR_FACTOR_H_
