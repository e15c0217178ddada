#include "plumbline/solvers/reduced/calibrated_graph.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/pose_frame.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/terms/terms.h"

namespace plumbline {

CalibratedGraph::CalibratedGraph(const SlamGraph& given, const std::vector<double>& poses)
    : given_(given), graph_(given), poses_(poses) {
  WeighMotions();
}

void CalibratedGraph::WeighMotions() {
  const double scale = std::exp(theta_[kLogOdometryScale]);
  weighed_motions_.clear();
  for (const OdometryConstraint& c : given_.odometry()) {
    const Pose2 motion = Between(Pose2(&poses_[3 * c.from]), Pose2(&poses_[3 * c.to]));
    weighed_motions_.push_back({motion.x / scale, motion.y / scale, motion.yaw});
  }
}

Pose2 CalibratedGraph::MountingAt(int laser, const CalibrationVector& theta) const {
  const Pose2& given = given_.laser(laser).robot_from_laser;
  return {given.x + theta[kMountingX], given.y + theta[kMountingY],
          given.yaw + theta[kMountingYaw]};
}

void CalibratedGraph::Set(const CalibrationVector& theta, const std::vector<double>& poses) {
  theta_ = theta;
  poses_ = poses;
  corrections_ = MeasurementCorrections();
  for (int i = 0; i < given_.num_lasers(); ++i) {
    corrections_.robot_from_laser.push_back(MountingAt(i, theta));
  }
  const double range_scale = std::exp(theta[kLogRangeScale]);
  corrections_.range_m.reserve(given_.num_returns());
  for (const float range_m : given_.returns().range_m) {
    corrections_.range_m.push_back(range_scale * (range_m + theta[kRangeBias]));
  }
  const double odometry_scale = std::exp(theta[kLogOdometryScale]);
  for (const OdometryConstraint& c : given_.odometry()) {
    const Pose2& motion = c.from_from_to;
    corrections_.odometry.push_back(
        {odometry_scale * motion.x, odometry_scale * motion.y, motion.yaw});
  }
  graph_ = std::move(graph_).Corrected(corrections_);
}

std::vector<double> CalibratedGraph::Carried(const CalibrationVector& to,
                                             const std::vector<double>& poses) const {
  const Pose2 robot_from_laser = MountingAt(0, theta_);
  const Pose2 laser_from_robot = MountingAt(0, to).Inverse();
  const double growth = std::exp(to[kLogRangeScale] - theta_[kLogRangeScale]);
  const Pose2 anchor(&poses[3 * Anchor()]);
  const Pose2 fixed = anchor * robot_from_laser;
  const auto carry = [&](const Pose2& pose) {
    const Pose2 laser = pose * robot_from_laser;
    return Pose2(fixed.x + growth * (laser.x - fixed.x), fixed.y + growth * (laser.y - fixed.y),
                 laser.yaw) *
           laser_from_robot;
  };
  // The map turns with the anchor, which has to stay.
  const Pose2 back = anchor * carry(anchor).Inverse();
  std::vector<double> carried;
  carried.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); i += 3) {
    const Pose2 pose = back * carry(Pose2(&poses[i]));
    carried.insert(carried.end(), {pose.x, pose.y, pose.yaw});
  }
  return carried;
}

CalibrationRows CalibratedGraph::CarriedBy(int pose) const {
  const Pose2 here(&poses_[3 * pose]), anchor(&poses_[3 * Anchor()]);
  const Eigen::Vector2d lever = MountingAt(0, theta_).translation();
  const Eigen::Vector2d from_anchor = here.translation() - anchor.translation();
  Eigen::Matrix2d turn;  // what the two poses' axes differ by
  turn.col(0) << std::cos(here.yaw) - std::cos(anchor.yaw),
      std::sin(here.yaw) - std::sin(anchor.yaw);
  turn.col(1) = TurnedLeft(turn.col(0));
  CalibrationRows rows = CalibrationRows::Zero();
  rows.topLeftCorner<2, 2>() = -turn;
  rows.col(kMountingYaw).head<2>() = turn * TurnedLeft(lever) + TurnedLeft(from_anchor);
  rows.col(kLogRangeScale).head<2>() = turn * lever + from_anchor;
  return rows;
}

PoseEdges CalibratedGraph::Edges(const FactorOptions& factors) const {
  PoseEdges edges(graph_, factors);
  const double scale = std::exp(theta_[kLogOdometryScale]);
  for (std::size_t i = 0; i < weighed_motions_.size(); ++i) {
    MotionResidual& residual = edges.motions[i].residual;
    residual.sqrt_information =
        MakeMotionResidual(weighed_motions_[i], factors.motion).sqrt_information;
    residual.sqrt_information.leftCols<2>() /= scale;
  }
  return edges;
}

PoseTerms CalibratedGraph::Terms(const FactorOptions& factors) const {
  PoseTerms terms(graph_, factors);
  terms.terms.front() = MakeMotionTerm(Edges(factors).motions);
  return terms;
}

SurfaceNoise CalibratedGraph::Noise(const FactorOptions& factors) const {
  SurfaceNoise noise = NoiseOf(factors);
  const double squared_scale = std::exp(2.0 * theta_[kLogRangeScale]);
  noise.range_variance *= squared_scale;
  noise.surface_variance *= squared_scale;
  return noise;
}

}  // namespace plumbline
