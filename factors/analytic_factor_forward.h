#ifndef PLUMBLINE_FACTORS_ANALYTIC_FACTOR_FORWARD_H_
#define PLUMBLINE_FACTORS_ANALYTIC_FACTOR_FORWARD_H_

namespace plumbline {

/// Defined in analytic_factor.h. Who makes no cost function of a residual needs no header of Ceres.
template <typename Residual, int kNumResiduals, int... kBlockSizes>
class AnalyticFactor;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_ANALYTIC_FACTOR_FORWARD_H_
