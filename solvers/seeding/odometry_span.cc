#include "plumbline/solvers/seeding/odometry_span.h"

#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/seeding/match_covariance.h"

namespace plumbline {

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
