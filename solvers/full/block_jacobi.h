#ifndef PLUMBLINE_SOLVERS_FULL_BLOCK_JACOBI_H_
#define PLUMBLINE_SOLVERS_FULL_BLOCK_JACOBI_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <cstddef>
#include <vector>

#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// Preconditioner of N x N diagonal blocks. The result does not depend on the number of threads.
template <int N>
class BlockJacobi {
 public:
  /// upper_triangles: N (N + 1) / 2 entries per block, row by row. A block that is not positive
  /// definite, to rounding, is seen by too few residuals; its variables are held where they are.
  void Set(const std::vector<double>& upper_triangles, ThreadPool* pool) {
    constexpr int kUpper = N * (N + 1) / 2;
    inverses_.resize(upper_triangles.size() / kUpper);
    pool->ForEachChunk(inverses_.size(), kBlocksPerChunk,
                       [&](std::size_t, std::size_t begin, std::size_t end) {
                         for (std::size_t b = begin; b < end; ++b) {
                           inverses_[b] = Inverse(&upper_triangles[kUpper * b]);
                         }
                       });
  }

  /// result = P^-1 gradient.
  void Apply(const std::vector<double>& gradient, ThreadPool* pool,
             std::vector<double>* result) const {
    using Vector = Eigen::Matrix<double, N, 1>;
    result->resize(gradient.size());
    pool->ForEachChunk(inverses_.size(), kBlocksPerChunk,
                       [&](std::size_t, std::size_t begin, std::size_t end) {
                         for (std::size_t b = begin; b < end; ++b) {
                           Eigen::Map<Vector>(result->data() + N * b) =
                               inverses_[b] * Eigen::Map<const Vector>(gradient.data() + N * b);
                         }
                       });
  }

 private:
  using Block = Eigen::Matrix<double, N, N>;

  static constexpr std::size_t kBlocksPerChunk = 8192;

  /// A pivot below this share of its diagonal entry is rounding.
  static constexpr double kMinPivotShare = 1e-12;

  static Block Inverse(const double* upper) {
    Block matrix;
    for (int i = 0; i < N; ++i) {
      for (int j = i; j < N; ++j) matrix(i, j) = matrix(j, i) = *upper++;
    }
    const Eigen::LLT<Block> llt(matrix);
    if (llt.info() != Eigen::Success) return Block::Zero();
    const auto pivots = llt.matrixLLT().diagonal().array().square();
    if (!(pivots > kMinPivotShare * matrix.diagonal().array()).all()) return Block::Zero();
    return matrix.inverse();
  }

  std::vector<Block> inverses_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_BLOCK_JACOBI_H_
