#ifndef PLUMBLINE_FACTORS_MANIFOLD_FACTOR_H_
#define PLUMBLINE_FACTORS_MANIFOLD_FACTOR_H_

#include <cmath>

#include "plumbline/factors/analytic_factor_forward.h"

namespace plumbline {

/// All points m of the world with n . m = offset, n a unit normal. [m]
struct TangentLine {
  double normal_x = 1.0;  ///< world frame
  double normal_y = 0.0;  ///< world frame
  double offset = 0.0;    ///< [m]
};

/// Manifold potential: a map point m lies on the tangent line of its neighbourhood,
///   residual = (n . m - offset) / sigma.
/// Point: x, y [m] in the world. Residual: 1, dimensionless. d_point is 1x2 and may be null. No
/// singularities. Returns false if the result is not finite.
inline bool EvaluateManifold(const TangentLine& line, const double* point_in_world,
                             double inv_sigma, double* residual, double* d_point) {
  *residual =
      (line.normal_x * point_in_world[0] + line.normal_y * point_in_world[1] - line.offset) *
      inv_sigma;
  if (d_point != nullptr) {
    d_point[0] = line.normal_x * inv_sigma;
    d_point[1] = line.normal_y * inv_sigma;
  }
  return std::isfinite(*residual);
}

/// EvaluateManifold for one point. Block: point_in_world (2).
struct ManifoldResidual {
  TangentLine line;        ///< of the neighbourhood
  double inv_sigma = 1.0;  ///< [1/m]

  /// EvaluateManifold with these.
  bool Evaluate(const double* point_in_world, double* residual, double* d_point) const {
    return EvaluateManifold(line, point_in_world, inv_sigma, residual, d_point);
  }
};

using ManifoldFactor = AnalyticFactor<ManifoldResidual, 1, 2>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_MANIFOLD_FACTOR_H_
