#include "plumbline/solvers/pose_graph/robust_pose_graph.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/float_environment.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/pose_graph/pose_equations.h"
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
};

// One graph, its poses unknown.
class System {
 public:
  System(const std::vector<RelativePoseConstraint>& certain,
         const std::vector<RelativePoseConstraint>& uncertain, std::size_t num_poses)
      : edges_(EdgesOf(certain, uncertain)), equations_(num_poses, PairsOf(edges_)) {}

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
    const Eigen::VectorXd step = equations_.Step(poses);
    return step.size() > 0 ? step.cwiseAbs().maxCoeff() : -1.0;
  }

 private:
  static std::vector<ResidualEdge> EdgesOf(const std::vector<RelativePoseConstraint>& certain,
                                           const std::vector<RelativePoseConstraint>& uncertain) {
    std::vector<ResidualEdge> edges;
    Append(certain, false, &edges);
    Append(uncertain, true, &edges);
    return edges;
  }

  static void Append(const std::vector<RelativePoseConstraint>& constraints, bool uncertain,
                     std::vector<ResidualEdge>* edges) {
    for (const RelativePoseConstraint& constraint : constraints) {
      if (constraint.from == constraint.to) continue;  // says nothing of where it is
      ResidualEdge edge;
      edge.from = constraint.from;
      edge.to = constraint.to;
      edge.uncertain = uncertain;
      edge.residual.a_from_b = constraint.from_from_to;
      if (SqrtInformation(constraint.covariance, &edge.residual.sqrt_information)) {
        edges->push_back(edge);
      }
    }
  }

  static std::vector<std::pair<int, int>> PairsOf(const std::vector<ResidualEdge>& edges) {
    std::vector<std::pair<int, int>> pairs;
    pairs.reserve(edges.size());
    for (const ResidualEdge& edge : edges) pairs.emplace_back(edge.from, edge.to);
    return pairs;
  }

  static Eigen::Vector3d Error(const ResidualEdge& edge, const std::vector<Pose2>& poses) {
    Eigen::Vector3d error;
    const Pose2 &a = poses[edge.from], &b = poses[edge.to];
    const double from[] = {a.x, a.y, a.yaw}, to[] = {b.x, b.y, b.yaw};
    edge.residual.Evaluate(from, to, error.data(), nullptr, nullptr);
    return error;
  }

  void Linearize(double cauchy_scale, const std::vector<Pose2>& poses) {
    equations_.SetZero();
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const ResidualEdge& edge = edges_[i];
      const Pose2 &a = poses[edge.from], &b = poses[edge.to];
      const double from[] = {a.x, a.y, a.yaw}, to[] = {b.x, b.y, b.yaw};
      Eigen::Vector3d error;
      RowMajor3d d_from, d_to;
      edge.residual.Evaluate(from, to, error.data(), d_from.data(), d_to.data());
      const double weight =
          edge.uncertain ? 1.0 / (1.0 + error.squaredNorm() / (cauchy_scale * cauchy_scale)) : 1.0;
      equations_.Add(i, weight, d_from, d_to, error);
    }
  }

  std::vector<ResidualEdge> edges_;
  PoseGraphEquations equations_;
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
