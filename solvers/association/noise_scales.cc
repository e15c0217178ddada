#include "plumbline/solvers/association/noise_scales.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

namespace {

// A stretch of surface of half length r, seen with standard deviation s across it, has variances
// r^2 / 3 and s^2: below 4.5 s even a perfect wall fails kMaxEigenvalueRatio.
double SmallestUsefulRadius(const FactorOptions& factors) {
  return 5.0 * std::hypot(factors.beam.sigma_range_m, factors.manifold.sigma_m);
}

}  // namespace

ReturnNormalOptions NormalOptionsFor(const RangeBeamOptions& beam) {
  ReturnNormalOptions options;
  options.half_window_m = std::max(0.06, 6.0 * beam.sigma_range_m);
  return options;
}

double FineRadius(const SolverOptions& options) {
  return std::max(options.rounds.fine_radius_m, SmallestUsefulRadius(options.factors));
}

}  // namespace plumbline
