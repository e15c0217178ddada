#include "plumbline/solvers/pose_graph/robust_pose_graph.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/float_environment.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/pose_graph/block_cholesky.h"
#include "plumbline/solvers/pose_graph/uncertain_edges.h"

namespace plumbline {
namespace {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// The loss narrows by this factor from step to step.
constexpr double kStepNarrowing = 2.0;
// Steps at the final width, at most, ...
constexpr int kMaxFinalSteps = 15;
// ... which end once none of the poses moves by this much [m], [rad]: a tenth of what a scan match
// knows; ...
constexpr double kTolerance = 3e-4;
// ... or once a step explains the edges better by no more than this [sigmas^2]: what still moves is
// held by nothing.
constexpr double kCostTolerance = 0.1;

struct ResidualEdge {
  int from = 0, to = 0;
  bool uncertain = false;
  RelativePoseResidual residual;
  std::size_t coupling = 0;  // of its poses, unless one of them is pose 0
};

// The normal equations of one graph. Their pattern stays, their values change. Pose 0 is no
// unknown: node n is pose n + 1.
class System {
 public:
  System(const std::vector<RelativePoseConstraint>& certain,
         const std::vector<RelativePoseConstraint>& uncertain, std::size_t num_poses)
      : right_(3 * (static_cast<Eigen::Index>(num_poses) - 1)) {
    Append(certain, false);
    Append(uncertain, true);
    std::vector<std::pair<int, int>> couplings;
    couplings.reserve(edges_.size());
    for (const ResidualEdge& edge : edges_) {
      if (IsCoupling(edge)) couplings.emplace_back(edge.from - 1, edge.to - 1);
    }
    equations_ = BlockCholesky(static_cast<int>(num_poses) - 1, couplings);
    for (ResidualEdge& edge : edges_) {
      if (IsCoupling(edge)) edge.coupling = equations_.FindCoupling(edge.from - 1, edge.to - 1);
    }
  }

  // Largest whitened error of an uncertain edge.
  double WorstError(const std::vector<Pose2>& poses) const {
    double worst = 0.0;
    for (const ResidualEdge& edge : edges_) {
      if (edge.uncertain) worst = std::max(worst, Error(edge, poses).norm());
    }
    return worst;
  }

  // Under the loss of this width.
  double Cost(double cauchy_scale, const std::vector<Pose2>& poses) const {
    const double scale_squared = cauchy_scale * cauchy_scale;
    double cost = 0.0;
    for (const ResidualEdge& edge : edges_) {
      const double chi2 = Error(edge, poses).squaredNorm();
      cost += edge.uncertain ? scale_squared * std::log1p(chi2 / scale_squared) : chi2;
    }
    return cost;
  }

  // One step of Gauss-Newton with the weights of the loss at this width. Returns the largest change
  // of a coordinate, or a negative number if there is no step.
  double Step(double cauchy_scale, std::vector<Pose2>* poses) {
    Linearize(cauchy_scale, *poses);
    if (!equations_.Factorize()) return -1.0;
    Eigen::VectorXd step = right_;
    equations_.Solve(&step);
    if (!step.allFinite()) return -1.0;
    for (std::size_t p = 1; p < poses->size(); ++p) {
      const auto change = step.segment<3>(3 * static_cast<Eigen::Index>(p - 1));
      (*poses)[p].x += change.x();
      (*poses)[p].y += change.y();
      (*poses)[p].yaw += change.z();
    }
    return step.size() > 0 ? step.cwiseAbs().maxCoeff() : 0.0;
  }

 private:
  void Append(const std::vector<RelativePoseConstraint>& constraints, bool uncertain) {
    for (const RelativePoseConstraint& constraint : constraints) {
      if (constraint.from == constraint.to) continue;  // says nothing of where it is
      ResidualEdge edge;
      edge.from = constraint.from;
      edge.to = constraint.to;
      edge.uncertain = uncertain;
      edge.residual.a_from_b = constraint.from_from_to;
      if (SqrtInformation(constraint.covariance, &edge.residual.sqrt_information)) {
        edges_.push_back(edge);
      }
    }
  }

  static bool IsCoupling(const ResidualEdge& edge) { return edge.from > 0 && edge.to > 0; }

  static Eigen::Vector3d Error(const ResidualEdge& edge, const std::vector<Pose2>& poses) {
    Eigen::Vector3d error;
    const Pose2 &a = poses[edge.from], &b = poses[edge.to];
    const double from[] = {a.x, a.y, a.yaw}, to[] = {b.x, b.y, b.yaw};
    edge.residual.Evaluate(from, to, error.data(), nullptr, nullptr);
    return error;
  }

  void Linearize(double cauchy_scale, const std::vector<Pose2>& poses) {
    equations_.SetZero();
    right_.setZero();
    for (const ResidualEdge& edge : edges_) {
      const Pose2 &a = poses[edge.from], &b = poses[edge.to];
      const double from[] = {a.x, a.y, a.yaw}, to[] = {b.x, b.y, b.yaw};
      Eigen::Vector3d error;
      RowMajor3d d_from, d_to;
      edge.residual.Evaluate(from, to, error.data(), d_from.data(), d_to.data());
      const double weight =
          edge.uncertain ? 1.0 / (1.0 + error.squaredNorm() / (cauchy_scale * cauchy_scale)) : 1.0;
      if (edge.from > 0) {
        equations_.AddToDiagonal(edge.from - 1, weight * d_from.transpose() * d_from);
        right_.segment<3>(3 * edge.from - 3) -= weight * d_from.transpose() * error;
      }
      if (edge.to > 0) {
        equations_.AddToDiagonal(edge.to - 1, weight * d_to.transpose() * d_to);
        right_.segment<3>(3 * edge.to - 3) -= weight * d_to.transpose() * error;
      }
      if (!IsCoupling(edge)) continue;
      if (equations_.HasRowsOf(edge.from - 1, edge.to - 1)) {
        equations_.AddToCoupling(edge.coupling, weight * d_from.transpose() * d_to);
      } else {
        equations_.AddToCoupling(edge.coupling, weight * d_to.transpose() * d_from);
      }
    }
  }

  std::vector<ResidualEdge> edges_;
  BlockCholesky equations_;
  Eigen::VectorXd right_;
};

}  // namespace

void OptimizeRobustly(const std::vector<RelativePoseConstraint>& certain,
                      const std::vector<RelativePoseConstraint>& uncertain,
                      std::vector<Pose2>* world_from_pose) {
  if (world_from_pose->size() < 2) return;
  const DefaultFloatEnvironment float_environment;
  System system(certain, uncertain, world_from_pose->size());
  std::vector<Pose2> poses = *world_from_pose;
  double scale = kCauchyScale;
  const double worst = system.WorstError(poses);
  while (scale < worst) scale *= kStepNarrowing;
  for (; scale > kCauchyScale; scale /= kStepNarrowing) {
    if (system.Step(scale, &poses) < 0.0) return;
  }
  std::vector<Pose2> best = poses;
  double least_cost = system.Cost(kCauchyScale, poses);
  for (int i = 0; i < kMaxFinalSteps; ++i) {
    const double moved = system.Step(kCauchyScale, &poses);
    if (moved < 0.0) break;
    const double cost = system.Cost(kCauchyScale, poses);
    const double gain = least_cost - cost;
    if (gain > 0.0) {
      least_cost = cost;
      best = poses;
    }
    if (moved < kTolerance || std::abs(gain) < kCostTolerance) break;
  }
  *world_from_pose = std::move(best);
}

}  // namespace plumbline
