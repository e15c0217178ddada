#ifndef PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_SPAN_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_SPAN_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// Per pose the index into graph.odometry() of the step that leads to it from the pose before; -1
/// for pose 0. InvalidArgument if one is missing.
Status FindOdometrySteps(const SlamGraph& graph, std::vector<int>* step_to_pose);

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

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_SPAN_H_
