#ifndef PLUMBLINE_SOLVERS_REDUCED_POSE_CHAIN_H_
#define PLUMBLINE_SOLVERS_REDUCED_POSE_CHAIN_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/solvers/reduced/pose_system.h"

namespace plumbline {

/// A symmetric positive definite matrix of 3 x 3 blocks on the diagonal and next to it, factored.
class BlockTridiagonal {
 public:
  BlockTridiagonal() = default;
  /// lower: per row of blocks, the one left of the diagonal; that of the first row is not looked
  /// at.
  BlockTridiagonal(const std::vector<Eigen::Matrix3d>& diagonal,
                   const std::vector<Eigen::Matrix3d>& lower);

  std::size_t num_blocks() const { return inverse_.size(); }
  /// x: three numbers per block, the right-hand side and then the solution.
  void SolveInPlace(double* x) const;

 private:
  std::vector<Eigen::Matrix3d> inverse_;  // of the pivots
  std::vector<Eigen::Matrix3d> lower_;    // row i by row i - 1
};

/// The block-tridiagonal part of B of a pose system, by all of its rows: neighbouring poses, with
/// every pose held by the lines.
///
/// If the graph is shared, each process has stretches of the chain. It eliminates all rows of a
/// stretch but the first one. What is left, a chain of these first rows, is summed up and solved by
/// all processes alike, so that the solution is the same however the graph is divided. Collective
/// then.
class PoseChain {
 public:
  explicit PoseChain(const PoseSystem& system);

  /// Solves for the rows of this process. result: may not be v.
  void Solve(const Eigen::VectorXd& v, Eigen::VectorXd* result) const;

 private:
  // Rows that follow each other in the chain of all processes.
  struct Stretch {
    int id = 0;              // of all stretches of all processes, in the order of the chain
    std::size_t first = 0;   // row of this process
    BlockTridiagonal inner;  // the rows after it
    Eigen::Matrix3d to_first = Eigen::Matrix3d::Zero();  // from the first inner row
    Eigen::Matrix3d to_next = Eigen::Matrix3d::Zero();   // from the last row to the next stretch
    bool has_next = false;
  };

  std::vector<Stretch> FindStretches(const PoseSystem& system, std::size_t* num_stretches) const;
  // Adds what a stretch has to say of the first rows, its own and the next one.
  static void AddTo(const Stretch& stretch, const Eigen::Matrix3d& first_diagonal,
                    std::vector<Eigen::Matrix3d>* diagonal, std::vector<Eigen::Matrix3d>* lower);

  const Peers* peers_ = nullptr;
  BlockTridiagonal all_;  // of the rows; of the stretches' first rows, if the graph is shared
  std::vector<Stretch> stretches_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_POSE_CHAIN_H_
