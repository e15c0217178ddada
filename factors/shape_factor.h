#ifndef PLUMBLINE_FACTORS_SHAPE_FACTOR_H_
#define PLUMBLINE_FACTORS_SHAPE_FACTOR_H_

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "plumbline/factors/analytic_factor_forward.h"

namespace plumbline {

/// Angle from a region's normal to that of the adjacent region, to the nearest right angle.
enum class ShapeCategory { k0, k90, k180, k270 };

/// R_k^T v, where R_k turns by the angle of the category, counter-clockwise.
inline Eigen::Vector2d TurnBack(ShapeCategory category, const Eigen::Vector2d& v) {
  switch (category) {
    case ShapeCategory::k90:
      return {v.y(), -v.x()};
    case ShapeCategory::k180:
      return -v;
    case ShapeCategory::k270:
      return {-v.y(), v.x()};
    default:
      return v;
  }
}

/// Finds the category whose angle the turn from `normal` to `adjacent_normal` meets within
/// margin_rad (< pi / 4). Returns false if there is none, or if a normal is zero or not finite.
inline bool ClassifyShape(const Eigen::Vector2d& normal, const Eigen::Vector2d& adjacent_normal,
                          double margin_rad, ShapeCategory* category) {
  for (const ShapeCategory candidate :
       {ShapeCategory::k0, ShapeCategory::k90, ShapeCategory::k180, ShapeCategory::k270}) {
    const Eigen::Vector2d turned = TurnBack(candidate, adjacent_normal);
    const double cosine = normal.dot(turned);
    const double sine = normal.x() * turned.y() - normal.y() * turned.x();
    if (cosine > 0.0 && std::abs(std::atan2(sine, cosine)) <= margin_rad) {
      *category = candidate;
      return std::isfinite(cosine);
    }
  }
  return false;
}

/// Unit normal n = M d / |d| of the segment d = previous - current of one surface, M the turn by
/// +90 deg: the segment from current to previous, turned counter-clockwise.
inline Eigen::Vector2d SegmentNormal(const Eigen::Vector2d& previous,
                                     const Eigen::Vector2d& current) {
  const Eigen::Vector2d d = (previous - current).normalized();
  return {-d.y(), d.x()};
}

/// Shape potential: the normal n of a segment of surface agrees with the normal n* of an adjacent
/// region up to a right angle R_k,
///   residual = (R_k^T n* - n) / sigma,      n = SegmentNormal(previous, current),
/// which is (n* - R_k n) / sigma turned by R_k^T: same length, same cost. target_normal is R_k^T
/// n*. Points: x, y [m] in the world. Residual: 2, dimensionless; sigma [rad]. d_previous,
/// d_current are 2x2 row-major and may be null. Singular at d = previous - current = 0. With u = d
/// / |d|,
///   dn/dprevious = (1/|d|) (I - n n^T) M = -(1/|d|) u n^T = -dn/dcurrent.
///
/// Returns false if d = 0 or anything is not finite; the outputs then carry no meaning.
inline bool EvaluateShape(const double* previous_point, const double* current_point,
                          const Eigen::Vector2d& target_normal, double inv_sigma,
                          double residuals[2], double* d_previous, double* d_current) {
  const double dx = previous_point[0] - current_point[0];
  const double dy = previous_point[1] - current_point[1];
  const double squared_length = dx * dx + dy * dy;
  if (!(squared_length >= std::numeric_limits<double>::min()) || !std::isfinite(squared_length)) {
    return false;
  }
  const double inv_length = 1.0 / std::sqrt(squared_length);
  const double ux = dx * inv_length, uy = dy * inv_length;
  residuals[0] = (target_normal.x() + uy) * inv_sigma;
  residuals[1] = (target_normal.y() - ux) * inv_sigma;
  const double scale = inv_sigma * inv_length;
  // -dn/dprevious / sigma = u n^T / (|d| sigma), with n = (-uy, ux).
  const double jacobian[4] = {-scale * ux * uy, scale * ux * ux, -scale * uy * uy, scale * ux * uy};
  for (int i = 0; i < 4; ++i) {
    if (d_previous != nullptr) d_previous[i] = jacobian[i];
    if (d_current != nullptr) d_current[i] = -jacobian[i];
  }
  return std::isfinite(residuals[0]) && std::isfinite(residuals[1]);
}

/// EvaluateShape for one segment. Blocks: previous_point (2), current_point (2).
struct ShapeResidual {
  Eigen::Vector2d target_normal = Eigen::Vector2d::UnitX();  ///< of the segment: unit, world frame
  double inv_sigma = 1.0;                                    ///< [1/rad]

  /// adjacent_normal: unit, world frame.
  ShapeResidual(const Eigen::Vector2d& adjacent_normal, ShapeCategory category, double sigma_rad)
      : target_normal(TurnBack(category, adjacent_normal)), inv_sigma(1.0 / sigma_rad) {}

  /// EvaluateShape with these.
  bool Evaluate(const double* previous_point, const double* current_point, double* residuals,
                double* d_previous, double* d_current) const {
    return EvaluateShape(previous_point, current_point, target_normal, inv_sigma, residuals,
                         d_previous, d_current);
  }
};

using ShapeFactor = AnalyticFactor<ShapeResidual, 2, 2, 2>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_SHAPE_FACTOR_H_
