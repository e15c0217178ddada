#ifndef PLUMBLINE_FACTORS_ANALYTIC_FACTOR_H_
#define PLUMBLINE_FACTORS_ANALYTIC_FACTOR_H_

#include <ceres/sized_cost_function.h>

#include <cstddef>
#include <utility>

namespace plumbline {

/// Ceres cost function over a residual with analytic derivatives. Holds nothing but the residual:
/// a map has millions of these.
///
/// Residual is a value type with
///   bool Evaluate(const double* block_1, ..., double* residuals, double* d_block_1, ...) const;
/// d_block_i is row-major, kNumResiduals x kBlockSizes[i], and null where it is not wanted. It
/// returns false on degenerate or non-finite input; the outputs then carry no meaning.
template <typename Residual, int kNumResiduals, int... kBlockSizes>
class AnalyticFactor final : public ceres::SizedCostFunction<kNumResiduals, kBlockSizes...> {
 public:
  explicit AnalyticFactor(const Residual& residual) : residual_(residual) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    return Forward(blocks, residuals, jacobians,
                   std::make_index_sequence<sizeof...(kBlockSizes)>());
  }

 private:
  template <std::size_t... kBlocks>
  bool Forward(double const* const* blocks, double* residuals, double** jacobians,
               std::index_sequence<kBlocks...>) const {
    return residual_.Evaluate(blocks[kBlocks]..., residuals,
                              (jacobians != nullptr ? jacobians[kBlocks] : nullptr)...);
  }

  Residual residual_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_ANALYTIC_FACTOR_H_
