#ifndef PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_SPAN_H_
#define PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_SPAN_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// What the odometry says of the motion between two poses that are several steps apart.
struct OdometrySpan {
  Pose2 from_from_to;
  /// Order x, y [m], yaw [rad], in the frame of `from`.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Chains steps: odometry[p] leads from pose p - 1 to pose p.
OdometrySpan ChainOdometry(const std::vector<Pose2>& odometry, int from, int to,
                           const MotionOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_SPAN_H_
