#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_EQUATIONS_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_EQUATIONS_H_

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/pose_graph/block_cholesky.h"

namespace plumbline {

/// The share of residuals over two poses in the normal equations: J^T J and J^T e.
struct PairEquations {
  Eigen::Matrix3d from_from = Eigen::Matrix3d::Zero(), from_to = Eigen::Matrix3d::Zero(),
                  to_to = Eigen::Matrix3d::Zero();
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();

  /// d_from, d_to: Jacobians of the error, with three columns each.
  template <typename Jacobian, typename Error>
  void Add(double weight, const Jacobian& d_from, const Jacobian& d_to, const Error& error) {
    from_from += weight * d_from.transpose() * d_from;
    from_to += weight * d_from.transpose() * d_to;
    to_to += weight * d_to.transpose() * d_to;
    from += weight * d_from.transpose() * error;
    to += weight * d_to.transpose() * error;
  }

  PairEquations Reversed() const { return {to_to, from_to.transpose(), from_from, to, from}; }
};

/// The normal equations of residuals that relate two poses each. Their pattern stays, their values
/// change from step to step. Pose 0 is constant.
class PoseGraphEquations {
 public:
  /// pairs: (from, to), different poses each; below they are named by their order.
  PoseGraphEquations(std::size_t num_poses, const std::vector<std::pair<int, int>>& pairs)
      : right_(3 * (static_cast<Eigen::Index>(num_poses) - 1)) {
    std::vector<std::pair<int, int>> couplings;
    couplings.reserve(pairs.size());
    for (const auto& [from, to] : pairs) {
      if (from > 0 && to > 0) couplings.emplace_back(from - 1, to - 1);
    }
    left_ = BlockCholesky(static_cast<int>(num_poses) - 1, couplings);
    pairs_.reserve(pairs.size());
    for (const auto& [from, to] : pairs) {
      Pair pair{from - 1, to - 1};
      if (from > 0 && to > 0) {
        pair.coupling = left_.FindCoupling(pair.rows, pair.columns);
        pair.is_reversed = !left_.HasRowsOf(pair.rows, pair.columns);
      }
      if (pair.is_reversed) std::swap(pair.rows, pair.columns);
      pairs_.push_back(pair);
    }
  }

  void SetZero() {
    left_.SetZero();
    right_.setZero();
  }

  /// Adds one residual of a pair, see PairEquations::Add.
  template <typename Jacobian, typename Error>
  void Add(std::size_t pair, double weight, const Jacobian& d_from, const Jacobian& d_to,
           const Error& error) {
    const bool is_reversed = pairs_[pair].is_reversed;
    PairEquations equations;
    equations.Add(weight, is_reversed ? d_to : d_from, is_reversed ? d_from : d_to, error);
    AddBlocks(pairs_[pair], equations);
  }

  /// Adds what residuals of a pair sum up to.
  void Add(std::size_t pair, const PairEquations& equations) {
    AddBlocks(pairs_[pair], pairs_[pair].is_reversed ? equations.Reversed() : equations);
  }

  /// Moves all poses but pose 0 to the solution. Returns the step, three numbers per pose from pose
  /// 1 on; an empty one, with no pose moved, if the equations have no solution.
  Eigen::VectorXd Step(std::vector<Pose2>* poses) {
    if (!left_.Factorize()) return Eigen::VectorXd();
    Eigen::VectorXd step = right_;
    left_.Solve(&step);
    if (!step.allFinite()) return Eigen::VectorXd();
    for (std::size_t p = 1; p < poses->size(); ++p) {
      const auto change = step.segment<3>(3 * static_cast<Eigen::Index>(p - 1));
      (*poses)[p].x += change.x();
      (*poses)[p].y += change.y();
      (*poses)[p].yaw += change.z();
    }
    return step;
  }

 private:
  // As the matrix has it: pose p is node p - 1.
  struct Pair {
    int rows, columns;
    std::size_t coupling = 0;  // unless one of them is pose 0
    bool is_reversed = false;  // from has the columns
  };

  void AddBlocks(const Pair& pair, const PairEquations& equations) {
    AddToPose(pair.rows, equations.from_from, equations.from);
    AddToPose(pair.columns, equations.to_to, equations.to);
    if (pair.rows >= 0 && pair.columns >= 0) left_.AddToCoupling(pair.coupling, equations.from_to);
  }

  void AddToPose(int node, const Eigen::Matrix3d& left, const Eigen::Vector3d& right) {
    if (node < 0) return;
    left_.AddToDiagonal(node, left);
    right_.segment<3>(3 * node) -= right;
  }

  std::vector<Pair> pairs_;
  BlockCholesky left_;
  Eigen::VectorXd right_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_EQUATIONS_H_
