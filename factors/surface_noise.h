#ifndef PLUMBLINE_FACTORS_SURFACE_NOISE_H_
#define PLUMBLINE_FACTORS_SURFACE_NOISE_H_

#include <Eigen/Core>
#include <cmath>

#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// How far the measured end of a beam may lie off the surface that it met. Points whose beam and
/// manifold terms are minimised in closed form leave a residual of this variance.
struct SurfaceNoise {
  double range_variance = 0.0;    ///< along the beam [m^2]
  double bearing_variance = 0.0;  ///< of the beam's direction [rad^2]
  double surface_variance = 0.0;  ///< of a point off its tangent line [m^2]

  /// n^T C n [m^2], C the covariance of the beam's end. direction: of the beam, unit; normal: of
  /// the surface, unit, same frame.
  double BeamVariance(double range_m, const Eigen::Vector2d& direction,
                      const Eigen::Vector2d& normal) const {
    return BeamVarianceAt(direction.dot(normal),
                          range_m * (direction.x() * normal.y() - direction.y() * normal.x()));
  }
  /// The same by the components of the normal along the beam and, times its length [m], across.
  /// Scalar: double, or an array of them.
  template <typename Scalar>
  Scalar BeamVarianceAt(const Scalar& along, const Scalar& across) const {
    return range_variance * along * along + bearing_variance * across * across;
  }
  /// No less than BeamVariance at this range, and what the surface adds [m^2].
  double LargestVariance(double range_m) const {
    return surface_variance + range_variance + bearing_variance * range_m * range_m;
  }
  /// C n [m^2].
  Eigen::Vector2d BeamCovarianceTimes(double range_m, const Eigen::Vector2d& direction,
                                      const Eigen::Vector2d& normal) const {
    const double along = direction.x() * normal.x() + direction.y() * normal.y();
    const double across = direction.x() * normal.y() - direction.y() * normal.x();
    const double a = range_variance * along;
    const double b = bearing_variance * range_m * range_m * across;
    return {a * direction.x() - b * direction.y(), a * direction.y() + b * direction.x()};
  }

  /// Of a return that meets its surface at a right angle and close by [m].
  double StandardDeviation() const { return std::sqrt(range_variance + surface_variance); }
};

inline SurfaceNoise NoiseOf(const FactorOptions& factors) {
  return {factors.beam.sigma_range_m * factors.beam.sigma_range_m,
          factors.beam.sigma_bearing_rad * factors.beam.sigma_bearing_rad,
          factors.manifold.sigma_m * factors.manifold.sigma_m};
}

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_SURFACE_NOISE_H_
