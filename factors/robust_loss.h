#ifndef PLUMBLINE_FACTORS_ROBUST_LOSS_H_
#define PLUMBLINE_FACTORS_ROBUST_LOSS_H_

#include <algorithm>

namespace plumbline {

/// Factor on the robust gates while a solve starts: where the start has a wall twice, both sides
/// have to pull.
constexpr double kStartGateFactor = 2.0;

/// What a robust loss makes of one residual. Scalar: double, or an array of them, for as many
/// residuals.
template <typename Scalar>
struct RobustTermOf {
  Scalar rho;          ///< twice the cost
  Scalar information;  ///< in iteratively re-weighted least squares: rho' over the variance
};
using RobustTerm = RobustTermOf<double>;

/// Geman-McClure loss of the squared whitened residual s (both dimensionless):
///   rho(s) = a s / (a + s),   a = gate^2,
/// about s for small residuals and never more than a: an outlier far beyond the gate costs a
/// constant and pulls at nothing. Ceres' convention: the cost is rho / 2.
/// Source: Geman, McClure (1987); Zhang: Parameter estimation techniques (1997), table 1.
struct GemanMcClure {
  double scale_squared = 1.0;  ///< a

  /// Gate in standard deviations, > 0; infinity gives the Gaussian loss, rho(s) = s to rounding.
  static GemanMcClure FromGate(double gate_sigmas) {
    // So large that a / (a + s) is 1, and so small that a s is a double.
    constexpr double kGaussian = 1e40;
    return {std::min(gate_sigmas * gate_sigmas, kGaussian)};
  }

  /// The most that a return may cost where maps are compared, as rho, and the cost of one that has
  /// no line: that of a gate of four, or less. Otherwise, with a wide gate, to have any line would
  /// be worth more than to fit it.
  double ClutterRho() const { return std::min(scale_squared, 16.0); }

  double Rho(double s) const { return scale_squared * s / (scale_squared + s); }
  /// rho'(s): the factor on the residual's information in iteratively re-weighted least squares.
  double Weight(double s) const {
    const double ratio = scale_squared / (scale_squared + s);
    return ratio * ratio;
  }
  /// Of a residual of this variance, s = residual^2 / variance, by one division for both.
  template <typename Scalar>
  RobustTermOf<Scalar> Term(const Scalar& residual, const Scalar& variance) const {
    const Scalar squared = residual * residual;
    const Scalar factor = scale_squared / (scale_squared * variance + squared);
    return {squared * factor, variance * factor * factor};
  }
  /// rho''(s), negative throughout.
  double Curvature(double s) const { return -2.0 * Weight(s) / (scale_squared + s); }
};

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_ROBUST_LOSS_H_
