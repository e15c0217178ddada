#ifndef PLUMBLINE_SOLVERS_BLOCK_JACOBI_H_
#define PLUMBLINE_SOLVERS_BLOCK_JACOBI_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace plumbline {

/// Preconditioner of N x N diagonal blocks.
template <int N>
class BlockJacobi {
 public:
  /// upper_triangles: N (N + 1) / 2 entries per block, row by row. A block that is not positive
  /// definite is seen by too few residuals; its variables are held where they are.
  void Set(const std::vector<double>& upper_triangles) {
    constexpr int kUpper = N * (N + 1) / 2;
    inverses_.resize(upper_triangles.size() / kUpper);
    for (std::size_t b = 0; b < inverses_.size(); ++b) {
      inverses_[b] = Inverse(&upper_triangles[kUpper * b]);
    }
  }

  /// result = P^-1 gradient.
  void Apply(const std::vector<double>& gradient, std::vector<double>* result) const {
    using Vector = Eigen::Matrix<double, N, 1>;
    result->resize(gradient.size());
    for (std::size_t b = 0; b < inverses_.size(); ++b) {
      Eigen::Map<Vector>(result->data() + N * b) =
          inverses_[b] * Eigen::Map<const Vector>(gradient.data() + N * b);
    }
  }

 private:
  using Block = Eigen::Matrix<double, N, N>;

  static Block Inverse(const double* upper) {
    Block matrix;
    for (int i = 0; i < N; ++i) {
      for (int j = i; j < N; ++j) matrix(i, j) = matrix(j, i) = *upper++;
    }
    const Eigen::LLT<Block> llt(matrix);
    if (llt.info() != Eigen::Success) return Block::Zero();
    return llt.solve(Block::Identity());
  }

  std::vector<Block> inverses_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_BLOCK_JACOBI_H_
