#ifndef PLUMBLINE_FACTORS_MOTION_FACTOR_H_
#define PLUMBLINE_FACTORS_MOTION_FACTOR_H_

#include <Eigen/Core>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/relative_pose_factor.h"

namespace plumbline {

/// Covariance (order x, y [m], yaw [rad], in the frame of `from`) of an odometry step, by the
/// rotation-translation-rotation model of Thrun, Burgard, Fox: Probabilistic Robotics, ch. 5.4.
///
/// The step (dx, dy, dyaw) is read as: turn by rot1, drive trans, turn by rot2, where
///   trans = sign(dx) |(dx, dy)|              (a robot that backs up drives a negative distance),
///   rot1  = w atan2(sign(dx) dy, |dx|),      w = trans^2 / (trans^2 + (2 cm)^2),
///   rot2  = wrap(dyaw - rot1).
/// The direction of a step of no length is undefined; w fades it out smoothly, and what turning
/// there was goes to rot2. The three are independent, with standard deviations
///   sigma_rot1  = alpha_1 |rot1|  + alpha_2 |trans|,
///   sigma_trans = alpha_3 |trans| + alpha_4 (|rot1| + |rot2|),
///   sigma_rot2  = alpha_1 |rot2|  + alpha_2 |trans|,
/// carried to (dx, dy, dyaw) by the Jacobian J of the drive; the squared floors are added:
///   Sigma = J diag(sigma^2) J^T + diag(floors^2).
/// Positive definite for every finite step, standstill included, and options that pass Check.
Eigen::Matrix3d MotionCovariance(const Pose2& from_from_to, const MotionOptions& options);

/// The motion term is the relative pose error whitened with MotionCovariance: the same model to
/// first order, and smooth where (rot1, trans, rot2) are not. Blocks: world_from_from (3),
/// world_from_to (3).
using MotionResidual = RelativePoseResidual;
using MotionFactor = RelativePoseFactor;

/// A step that is not finite gives a residual whose Evaluate returns false.
MotionResidual MakeMotionResidual(const Pose2& from_from_to, const MotionOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_MOTION_FACTOR_H_
