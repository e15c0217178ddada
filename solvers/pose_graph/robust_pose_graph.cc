#include "plumbline/solvers/pose_graph/robust_pose_graph.h"

#include <Eigen/Core>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/float_environment.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/pose_graph/uncertain_edges.h"

namespace plumbline {
namespace {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using SparseMatrix = Eigen::SparseMatrix<double>;

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

// Where the columns of a block of 3 x 3 begin among the values of a sparse matrix.
using BlockColumns = std::array<int, 3>;

struct ResidualEdge {
  int from = 0, to = 0;
  bool uncertain = false;
  RelativePoseResidual residual;
  BlockColumns from_from{}, to_to{}, coupling{};  // what its poses have in the normal equations
};

// The normal equations of one graph: the upper triangle, its poses in an order that keeps the
// factorisation sparse. The pattern stays, the values change. Pose 0 is no unknown.
class System {
 public:
  System(const std::vector<RelativePoseConstraint>& certain,
         const std::vector<RelativePoseConstraint>& uncertain, std::size_t num_poses)
      : size_(3 * (static_cast<int>(num_poses) - 1)) {
    Append(certain, false);
    Append(uncertain, true);
    LayPattern();
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
    solver_.factorize(matrix_);
    if (solver_.info() != Eigen::Success) return -1.0;
    const Eigen::VectorXd step = solver_.solve(right_);
    if (!step.allFinite()) return -1.0;
    for (std::size_t p = 1; p < poses->size(); ++p) {
      const auto change = step.segment<3>(Row(static_cast<int>(p)));
      (*poses)[p].x += change.x();
      (*poses)[p].y += change.y();
      (*poses)[p].yaw += change.z();
    }
    return step.size() > 0 ? step.cwiseAbs().maxCoeff() : 0.0;
  }

 private:
  void Append(const std::vector<RelativePoseConstraint>& constraints, bool uncertain) {
    for (const RelativePoseConstraint& constraint : constraints) {
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

  // First of the three unknowns of a pose.
  int Row(int pose) const { return 3 * place_[pose - 1]; }

  // Of the poses, which needs a pattern of a ninth of the size.
  void ChooseOrder() {
    const int num_unknown = size_ / 3;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(edges_.size() + num_unknown);
    for (int p = 0; p < num_unknown; ++p) entries.emplace_back(p, p, 1.0);
    for (const ResidualEdge& edge : edges_) {
      if (edge.from > 0 && edge.to > 0) entries.emplace_back(edge.from - 1, edge.to - 1, 1.0);
    }
    SparseMatrix pattern(num_unknown, num_unknown);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> pose_at_place;
    Eigen::AMDOrdering<int>()(pattern, pose_at_place);  // takes the pattern with its transpose
    place_.resize(num_unknown);
    for (int i = 0; i < num_unknown; ++i) place_[pose_at_place.indices()[i]] = i;
  }

  void LayPattern() {
    ChooseOrder();
    std::vector<std::pair<int, int>> blocks;  // column, row: first unknowns
    blocks.reserve(edges_.size() + place_.size());
    for (int row = 0; row < size_; row += 3) blocks.emplace_back(row, row);
    for (const ResidualEdge& edge : edges_) {
      if (edge.from == 0 || edge.to == 0) continue;
      const auto [row, column] = std::minmax({Row(edge.from), Row(edge.to)});
      blocks.emplace_back(column, row);
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    matrix_.resize(size_, size_);
    matrix_.reserve(static_cast<Eigen::Index>(9 * blocks.size()));
    for (auto first = blocks.begin(); first != blocks.end();) {
      const auto last = std::find_if(first, blocks.end(), [&](const std::pair<int, int>& block) {
        return block.first != first->first;
      });
      for (int j = 0; j < 3; ++j) {
        const int column = first->first + j;
        matrix_.startVec(column);
        for (auto block = first; block != last; ++block) {
          for (int i = 0; i < 3 && block->second + i <= column; ++i) {
            matrix_.insertBack(block->second + i, column) = 0.0;
          }
        }
      }
      first = last;
    }
    matrix_.finalize();
    for (ResidualEdge& edge : edges_) {
      if (edge.from > 0) edge.from_from = FindBlock(Row(edge.from), Row(edge.from));
      if (edge.to > 0) edge.to_to = FindBlock(Row(edge.to), Row(edge.to));
      if (edge.from == 0 || edge.to == 0) continue;
      const auto [row, column] = std::minmax({Row(edge.from), Row(edge.to)});
      edge.coupling = FindBlock(row, column);
    }
    solver_.analyzePattern(matrix_);
  }

  BlockColumns FindBlock(int row, int first_column) const {
    BlockColumns at;
    for (int j = 0; j < 3; ++j) {
      const int* const indices = matrix_.innerIndexPtr();
      const int* const outer = matrix_.outerIndexPtr() + first_column + j;
      at[j] =
          static_cast<int>(std::lower_bound(indices + outer[0], indices + outer[1], row) - indices);
    }
    return at;
  }

  static Eigen::Vector3d Error(const ResidualEdge& edge, const std::vector<Pose2>& poses) {
    Eigen::Vector3d error;
    const Pose2 &a = poses[edge.from], &b = poses[edge.to];
    const double from[] = {a.x, a.y, a.yaw}, to[] = {b.x, b.y, b.yaw};
    edge.residual.Evaluate(from, to, error.data(), nullptr, nullptr);
    return error;
  }

  void Linearize(double cauchy_scale, const std::vector<Pose2>& poses) {
    std::fill(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros(), 0.0);
    right_ = Eigen::VectorXd::Zero(size_);
    for (const ResidualEdge& edge : edges_) {
      const Pose2 &a = poses[edge.from], &b = poses[edge.to];
      const double from[] = {a.x, a.y, a.yaw}, to[] = {b.x, b.y, b.yaw};
      Eigen::Vector3d error;
      RowMajor3d d_from, d_to;
      edge.residual.Evaluate(from, to, error.data(), d_from.data(), d_to.data());
      const double weight =
          edge.uncertain ? 1.0 / (1.0 + error.squaredNorm() / (cauchy_scale * cauchy_scale)) : 1.0;
      if (edge.from > 0) {
        AddDiagonalBlock(edge.from_from, weight * d_from.transpose() * d_from);
        right_.segment<3>(Row(edge.from)) -= weight * d_from.transpose() * error;
      }
      if (edge.to > 0) {
        AddDiagonalBlock(edge.to_to, weight * d_to.transpose() * d_to);
        right_.segment<3>(Row(edge.to)) -= weight * d_to.transpose() * error;
      }
      if (edge.from == 0 || edge.to == 0) continue;
      if (Row(edge.from) < Row(edge.to)) {
        AddBlock(edge.coupling, weight * d_from.transpose() * d_to);
      } else {
        AddBlock(edge.coupling, weight * d_to.transpose() * d_from);
      }
    }
  }

  void AddBlock(const BlockColumns& at, const Eigen::Matrix3d& block) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) matrix_.valuePtr()[at[j] + i] += block(i, j);
    }
  }

  void AddDiagonalBlock(const BlockColumns& at, const Eigen::Matrix3d& block) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i <= j; ++i) matrix_.valuePtr()[at[j] + i] += block(i, j);
    }
  }

  int size_;  // of the system
  std::vector<ResidualEdge> edges_;
  std::vector<int> place_;  // of pose p + 1 in the order of the unknowns
  SparseMatrix matrix_;
  Eigen::VectorXd right_;
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Upper, Eigen::NaturalOrdering<int>> solver_;
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
