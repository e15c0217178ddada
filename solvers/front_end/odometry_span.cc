#include "plumbline/solvers/front_end/odometry_span.h"

#include <cstddef>
#include <string>

#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"

namespace plumbline {

Status FindOdometrySteps(const SlamGraph& graph, std::vector<int>* step_to_pose) {
  step_to_pose->assign(graph.num_poses(), -1);
  for (std::size_t i = 0; i < graph.odometry().size(); ++i) {
    const OdometryConstraint& step = graph.odometry()[i];
    if (step.to == step.from + 1) (*step_to_pose)[step.to] = static_cast<int>(i);
  }
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    if ((*step_to_pose)[pose] < 0) {
      return Status::InvalidArgument("seeding needs odometry from pose " +
                                     std::to_string(pose - 1) + " to pose " + std::to_string(pose) +
                                     ", but the graph has none");
    }
  }
  return Status::Ok();
}

OdometrySpan ChainOdometry(const std::vector<Pose2>& odometry, int from, int to,
                           const MotionOptions& options) {
  OdometrySpan span;
  for (int pose = from + 1; pose <= to; ++pose) {
    const double yaw = span.from_from_to.yaw;
    const Eigen::Vector2d arm = Pose2(0.0, 0.0, yaw) * odometry[pose].translation();
    Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
    carried(0, 2) = -arm.y();
    carried(1, 2) = arm.x();
    span.covariance = carried * span.covariance * carried.transpose() +
                      RotateAxes(MotionCovariance(odometry[pose], options), yaw);
    span.from_from_to = span.from_from_to * odometry[pose];
  }
  return span;
}

}  // namespace plumbline
