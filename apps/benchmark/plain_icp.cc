#include "plumbline/apps/benchmark/plain_icp.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/solvers/front_end/align_points.h"

namespace plumbline {
namespace {

// Fewer correspondences leave no residual to estimate a covariance from.
constexpr Eigen::Index kMinCorrespondences = 3;
constexpr int kMaxPlainIterations = 100;
constexpr double kPlainStepToleranceM = 1e-4;

// Paired columns [m]: points of `from` in its frame, points of `to` in theirs.
struct Correspondences {
  explicit Correspondences(Eigen::Index capacity) : in_from(2, capacity), in_to(2, capacity) {}

  void Add(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    in_from.col(count) = from;
    in_to.col(count++) = to;
  }

  Eigen::Matrix2Xd in_from, in_to;
  Eigen::Index count = 0;
};

Eigen::Matrix3d FitCovariance(const Correspondences& pairs, const Pose2& from_from_to) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double squared_error = 0.0;
  for (Eigen::Index i = 0; i < pairs.count; ++i) {
    const Eigen::Vector2d point = from_from_to * Eigen::Vector2d(pairs.in_to.col(i));
    const Eigen::Vector2d arm = point - from_from_to.translation();
    Eigen::Matrix<double, 2, 3> jacobian;
    jacobian << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    information += jacobian.transpose() * jacobian;
    squared_error += (point - pairs.in_from.col(i)).squaredNorm();
  }
  // Residuals of 0, as of a scan matched with itself, must leave the covariance positive definite.
  constexpr double kMinVariance = 1e-8;  // (0.1 mm)^2
  const double freedoms = 2.0 * static_cast<double>(pairs.count) - 3.0;
  return std::max(squared_error / freedoms, kMinVariance) * information.inverse();
}

}  // namespace

PlainIcp::PlainIcp(const SlamGraph& graph) : graph_(graph) {
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    const ScanReturns returns = graph.ReturnsOfScan(scan);
    const std::size_t first = graph.scan(scan).first_return;
    const std::size_t count = graph.scan(scan).num_returns;
    Eigen::Matrix2Xd points(2, count);
    for (std::size_t i = 0; i < count; ++i) points.col(i) = returns.PointInRobot(first + i);
    const double reach_m = count > 0 ? points.colwise().norm().maxCoeff() : 0.0;
    PointIndex index(std::vector<double>(points.data(), points.data() + points.size()));
    scans_.push_back({std::move(points), std::move(index), reach_m});
  }
}

PlainMatch PlainIcp::Match(int from, int to, const Pose2& guess,
                           const PlainIcpOptions& options) const {
  const Scan &map = scans_[from], &scan = scans_[to];
  PlainMatch match;
  match.from_from_to = guess;
  std::vector<PointIndex::Neighbor> nearest;
  for (int iteration = 0; iteration < kMaxPlainIterations && !match.converged; ++iteration) {
    Correspondences pairs(scan.points.cols());
    for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
      const Eigen::Vector2d point = scan.points.col(i);
      map.index.FindNearest(match.from_from_to * point, 1, &nearest);
      if (nearest.empty() || !(nearest[0].squared_distance <= options.gate_m * options.gate_m)) {
        continue;
      }
      pairs.Add(map.points.col(nearest[0].point), point);
    }
    if (pairs.count < kMinCorrespondences) {
      return {guess, Eigen::Matrix3d::Identity(), 0.0, false};
    }
    const Pose2 before = match.from_from_to;
    match.from_from_to =
        AlignPoints(pairs.in_from.leftCols(pairs.count), pairs.in_to.leftCols(pairs.count));
    match.covariance = FitCovariance(pairs, match.from_from_to);
    match.matched_ratio =
        static_cast<double>(pairs.count) / static_cast<double>(scan.points.cols());
    const Pose2 step = Between(before, match.from_from_to);
    match.converged =
        step.translation().norm() + scan.reach_m * std::abs(step.yaw) < kPlainStepToleranceM;
  }
  return match;
}

std::vector<RelativePoseConstraint> PlainIcp::MatchConsecutive(
    const PlainIcpOptions& options) const {
  std::vector<RelativePoseConstraint> edges;
  for (const OdometryConstraint& step : graph_.odometry()) {
    const PlainMatch match = Match(step.from, step.to, step.from_from_to, options);
    edges.push_back({step.from, step.to, match.from_from_to, match.covariance});
  }
  return edges;
}

std::vector<Pose2> ChainEdges(const SlamGraph& graph,
                              const std::vector<RelativePoseConstraint>& consecutive) {
  std::vector<Pose2> poses = {graph.InitialPose(0)};
  for (const RelativePoseConstraint& edge : consecutive) {
    poses.push_back(poses[edge.from] * edge.from_from_to);
  }
  return poses;
}

}  // namespace plumbline
