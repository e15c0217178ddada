#include "plumbline/solvers/incremental/drive_graph.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/pose_graph/robust_pose_graph.h"

namespace plumbline {
namespace {

// Distance [m] and turn [rad] between keyframes of the scan matcher. MatchCovariance is that of a
// match from one keyframe to the next; a shorter step has a share of it.
constexpr double kMatchM = 0.25, kMatchRad = 0.35;
// Smallest share, of a step at standstill.
constexpr double kMinShare = 0.01;

// Corrections that landmarks follow by themselves [m]: of returns at this range [m].
constexpr double kBridgedM = 0.05, kReachM = 5.0;

// Largest path [m] between the ends of two relative poses that are near each other.
constexpr double kNearM = 10.0;

// Adds the Gauss-Newton information of a scan's returns against surfaces with their normals, in
// axes of the robot.
void AddInformation(const SlamGraph& graph, int scan_id, const MeasuredSurface& surface,
                    Eigen::Matrix3d* information) {
  const ScanEntry& scan = graph.scan(scan_id);
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  const double weight = 1.0 / (ScanMatchOptions().sigma_m * ScanMatchOptions().sigma_m);
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    if (surface.normals[r].IsNone() || graph.Moves(r)) continue;
    const Eigen::Vector2d normal = surface.normals[r].Direction();
    const Eigen::Vector2d point = returns.PointInRobot(r);
    const Eigen::Vector3d row(normal.x(), normal.y(),
                              point.x() * normal.y() - point.y() * normal.x());
    *information += weight * row * row.transpose();
  }
}

// Information of an error that is the sum of two independent ones.
Eigen::Matrix3d InformationOfSum(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Matrix3d sum = a + b + 1e-6 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d series = a * sum.inverse() * b;
  return 0.5 * (series + series.transpose());
}

// The relative pose of c as seen from a, from those of b as seen from a and of c as seen from b.
RelativePoseConstraint InSeries(const RelativePoseConstraint& first,
                                const RelativePoseConstraint& second) {
  const double yaw = first.from_from_to.yaw;
  const Eigen::Vector2d arm = Pose2(0.0, 0.0, yaw) * second.from_from_to.translation();
  Eigen::Matrix3d swing = Eigen::Matrix3d::Identity();
  swing(0, 2) = -arm.y();
  swing(1, 2) = arm.x();
  return {first.from, second.to, first.from_from_to * second.from_from_to,
          swing * first.covariance * swing.transpose() + RotateAxes(second.covariance, yaw)};
}

RelativePoseConstraint Reversed(const RelativePoseConstraint& edge) {
  const Pose2 to_from_from = edge.from_from_to.Inverse();
  Eigen::Matrix3d swing = Eigen::Matrix3d::Identity();
  swing(0, 2) = edge.from_from_to.y;
  swing(1, 2) = -edge.from_from_to.x;
  return {edge.to, edge.from, to_from_from,
          RotateAxes(swing * edge.covariance * swing.transpose(), to_from_from.yaw)};
}

}  // namespace

void DriveGraph::Extend(const SlamGraph& graph, const MeasuredSurface& surface) {
  step_to_.resize(graph.num_poses());
  information_of_pose_.resize(graph.num_poses(), Eigen::Matrix3d::Zero());
  for (; num_scans_ < graph.num_scans(); ++num_scans_) {
    AddInformation(graph, num_scans_, surface, &information_of_pose_[graph.scan(num_scans_).pose]);
  }
  for (; num_odometry_ < graph.odometry().size(); ++num_odometry_) {
    const OdometryConstraint& c = graph.odometry()[num_odometry_];
    const Eigen::Matrix3d covariance = MotionCovariance(c.from_from_to, motion_);
    if (c.to == c.from + 1) {
      step_to_[c.to].motion += covariance.inverse();
    } else {
      long_motions_.push_back({c.from, c.to, c.from_from_to, covariance});
    }
  }
}

void DriveGraph::Measure(int end, const std::vector<double>& poses) {
  for (int pose = static_cast<int>(world_from_pose_.size()); pose < end; ++pose) {
    const Pose2 here(&poses[3 * pose]);
    if (pose == 0) {
      world_from_pose_.push_back(here);
    } else {
      step_to_[pose].measured = Between(Pose2(&poses[3 * (pose - 1)]), here);
      world_from_pose_.push_back(world_from_pose_.back() * step_to_[pose].measured);
    }
    at_last_move_.push_back(world_from_pose_.back());
  }
}

void DriveGraph::Restart(const std::vector<double>& poses) {
  const int num_measured = static_cast<int>(world_from_pose_.size());
  world_from_pose_.clear();
  at_last_move_.clear();
  Measure(num_measured, poses);
}

RelativePoseConstraint DriveGraph::StepTo(int pose) const {
  const Step& step = step_to_[pose];
  const double share = std::clamp(std::hypot(step.measured.x, step.measured.y) / kMatchM +
                                      std::abs(step.measured.yaw) / kMatchRad,
                                  kMinShare, 1.0);
  const Eigen::Matrix3d match =
      2.0 * InformationOfSum(information_of_pose_[pose - 1],
                             RotateAxes(information_of_pose_[pose], step.measured.yaw));
  return {pose - 1, pose, step.measured, share * MatchCovariance(match, share * step.motion)};
}

// Needs from <= to.
RelativePoseConstraint DriveGraph::Chain(int from, int to) const {
  RelativePoseConstraint chain{from, from, Pose2(), Eigen::Matrix3d::Zero()};
  for (int pose = from + 1; pose <= to; ++pose) chain = InSeries(chain, StepTo(pose));
  return chain;
}

bool DriveGraph::AgreesWithOne(const RelativePoseConstraint& edge,
                               const std::vector<RelativePoseConstraint>& others) const {
  const auto chain = [this](int from, int to) {
    return from <= to ? Chain(from, to) : Reversed(Chain(to, from));
  };
  const auto is_near = [&](int a, int b) {
    double path_m = 0.0;
    for (int pose = std::min(a, b) + 1; pose <= std::max(a, b); ++pose) {
      path_m += step_to_[pose].measured.translation().norm();
      if (path_m > kNearM) return false;
    }
    return true;
  };
  for (RelativePoseConstraint other : others) {
    if ((other.from < other.to) != (edge.from < edge.to)) other = Reversed(other);
    if (!is_near(edge.from, other.from) || !is_near(edge.to, other.to)) continue;
    const RelativePoseConstraint around =
        InSeries(InSeries(chain(edge.from, other.from), other), chain(other.to, edge.to));
    const Pose2 error = Between(edge.from_from_to, around.from_from_to);
    const Eigen::Vector3d e(error.x, error.y, error.yaw);
    const Eigen::Matrix3d covariance =
        RotateAxes(edge.covariance + around.covariance, -edge.from_from_to.yaw);
    if (e.dot(covariance.inverse() * e) <= LoopAcceptance::kMaxRelief) return true;
  }
  return false;
}

void DriveGraph::Close(const std::vector<RelativePoseConstraint>& certain,
                       const std::vector<RelativePoseConstraint>& uncertain,
                       const std::vector<FixedPose>& fixed, std::vector<double>* poses) {
  std::vector<RelativePoseConstraint> edges = long_motions_;
  edges.insert(edges.end(), certain.begin(), certain.end());
  for (int pose = 1; pose < static_cast<int>(world_from_pose_.size()); ++pose) {
    edges.push_back(StepTo(pose));
  }
  const int first = fixed.empty() ? 0 : fixed.front().pose;
  for (std::size_t i = 1; i < fixed.size(); ++i) {
    constexpr double kExact = 1e-8;  // [m^2], [rad^2]
    edges.push_back({first, fixed[i].pose,
                     Between(fixed.front().world_from_robot, fixed[i].world_from_robot),
                     kExact * Eigen::Matrix3d::Identity()});
  }
  std::vector<Pose2> optimum = world_from_pose_;
  OptimizeRobustly(edges, uncertain, &optimum);
  const Pose2 back = world_from_pose_[first] * optimum[first].Inverse();
  double farthest_m = 0.0;
  for (std::size_t i = 0; i < optimum.size(); ++i) {
    optimum[i] = back * optimum[i];
    const Pose2 moved = Between(at_last_move_[i], optimum[i]);
    farthest_m = std::max(farthest_m, moved.translation().norm() + kReachM * std::abs(moved.yaw));
  }
  world_from_pose_ = std::move(optimum);
  if (farthest_m <= kBridgedM) return;
  at_last_move_ = world_from_pose_;
  *poses = PoseArray(world_from_pose_);
}

}  // namespace plumbline
