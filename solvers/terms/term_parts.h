#ifndef PLUMBLINE_SOLVERS_TERMS_TERM_PARTS_H_
#define PLUMBLINE_SOLVERS_TERMS_TERM_PARTS_H_

#include <ceres/problem.h>

#include <vector>

#include "plumbline/solvers/terms/term.h"

namespace plumbline {

/// What a term adds its residual blocks to.
struct TermProblem {
  ceres::Problem* problem = nullptr;
  ceres::LossFunction* loss = nullptr;  ///< as MakeLoss gave it
  double* poses = nullptr;              ///< the parameter blocks, one behind the other
  double* points = nullptr;
  std::vector<ceres::ResidualBlockId>* residual_blocks = nullptr;  ///< appended to
};

/// The loss of terms that have none.
struct NoLoss {
  double Rho(double s) const { return s; }
  double Weight(double) const { return 1.0; }
};

/// @{
/// The entries of a block in a StateView or a TermProblem; null if that has none.
template <typename State>
auto BlockOf(const State& state, PoseId pose) {
  return state.poses == nullptr ? nullptr : state.poses + 3 * pose.id;
}
template <typename State>
auto BlockOf(const State& state, PointId point) {
  return state.points == nullptr ? nullptr : state.points + 2 * point.id;
}
/// @}

/// Which kinds of blocks derivatives are wanted by.
template <bool kPoses, bool kPoints>
struct Wanted {
  static constexpr bool Has(PoseId) { return kPoses; }
  static constexpr bool Has(PointId) { return kPoints; }
};

/// Calls body with the Wanted of two flags: what is not wanted costs nothing then.
template <typename Body>
auto With(bool poses, bool points, const Body& body) {
  if (poses) return points ? body(Wanted<true, true>()) : body(Wanted<true, false>());
  return points ? body(Wanted<false, true>()) : body(Wanted<false, false>());
}

/// Adds rho' J^T r to the gradient and rho' J^T J to the upper triangle of the block of one
/// parameter block that a residual of size M sees.
template <typename Which, int M, typename Id>
void Accumulate(double weight, const double* residuals, const double* jacobian, Id id,
                const TermDerivatives& out) {
  if (!Which::Has(id)) return;
  constexpr int kSize = Id::kSize;
  if (double* gradient = out.Gradient(id)) {
    for (int i = 0; i < kSize; ++i) {
      double sum = 0.0;
      for (int k = 0; k < M; ++k) sum += jacobian[k * kSize + i] * residuals[k];
      gradient[i] += weight * sum;
    }
  }
  if (double* block = out.Block(id)) {
    for (int i = 0; i < kSize; ++i) {
      for (int j = i; j < kSize; ++j) {
        double sum = 0.0;
        for (int k = 0; k < M; ++k) sum += jacobian[k * kSize + i] * jacobian[k * kSize + j];
        *block++ += weight * sum;
      }
    }
  }
}

/// Adds J d to `product`, for one parameter block of a residual of size M.
template <typename Which, int M, typename Id>
void AddProduct(const double* jacobian, Id id, const StateView& direction, double* product) {
  if (!Which::Has(id)) return;
  const double* d = BlockOf(direction, id);
  for (int k = 0; k < M; ++k) {
    for (int i = 0; i < Id::kSize; ++i) product[k] += jacobian[k * Id::kSize + i] * d[i];
  }
}

/// Squared length.
template <int M>
double Square(const double (&r)[M]) {
  double s = 0.0;
  for (int k = 0; k < M; ++k) s += r[k] * r[k];
  return s;
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_TERM_PARTS_H_
