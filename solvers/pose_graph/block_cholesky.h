#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_BLOCK_CHOLESKY_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_BLOCK_CHOLESKY_H_

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

namespace plumbline {

/// Solves symmetric positive definite systems of blocks of 3 x 3, as pose graphs have them, again
/// and again for one pattern: L D L^T with blocks for entries, row by row. A factor of few blocks
/// per column costs a third of what it costs entry by entry.
/// Source: Davis: Algorithm 849: a concise sparse Cholesky factorization package (2005).
class BlockCholesky {
 public:
  BlockCholesky() = default;
  /// couplings: pairs of different nodes, in any order, also repeatedly. All blocks are zero.
  BlockCholesky(int num_nodes, const std::vector<std::pair<int, int>>& couplings);

  void SetZero();
  /// Adds to the block of a node on the diagonal.
  void AddToDiagonal(int node, const Eigen::Matrix3d& block) { diagonal_[place_[node]] += block; }
  /// Where the block of two nodes is that were given as a coupling, for AddToCoupling.
  std::size_t FindCoupling(int a, int b) const;
  /// Whether the rows of the block of two nodes are those of a; else they are those of b.
  bool HasRowsOf(int a, int b) const { return place_[a] < place_[b]; }
  void AddToCoupling(std::size_t coupling, const Eigen::Matrix3d& block) {
    couplings_[coupling] += block;
  }

  /// False if the matrix is not positive definite.
  bool Factorize();
  /// x: three numbers per node, the right side and then the solution.
  void Solve(Eigen::VectorXd* x) const;

 private:
  void ChooseOrder(const std::vector<std::pair<int, int>>& couplings);
  void LayPattern(const std::vector<std::pair<int, int>>& couplings);
  void Analyze();
  // The columns of L that have a block in this row, such that each comes before those it changes.
  // Marks what it meets in met_.
  void FindRow(int row);

  int num_nodes() const { return static_cast<int>(diagonal_.size()); }

  std::vector<int> place_;  // of each node in the order of elimination, by which the rest goes
  std::vector<Eigen::Matrix3d> diagonal_;
  // The upper triangle by columns.
  std::vector<std::size_t> first_of_column_;
  std::vector<int> row_of_coupling_;
  std::vector<Eigen::Matrix3d> couplings_;

  std::vector<int> parent_;  // elimination tree
  std::vector<std::size_t> first_of_factor_;
  std::vector<std::size_t> end_of_factor_;  // of the blocks found so far
  std::vector<int> row_of_factor_;
  std::vector<Eigen::Matrix3d> factor_;
  std::vector<Eigen::Matrix3d> inverse_pivot_;
  // Of the row at hand.
  std::vector<int> met_, in_row_, path_;
  std::vector<Eigen::Matrix3d> solution_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_BLOCK_CHOLESKY_H_
