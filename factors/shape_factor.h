#ifndef PLUMBLINE_FACTORS_SHAPE_FACTOR_H_
#define PLUMBLINE_FACTORS_SHAPE_FACTOR_H_

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "plumbline/factors/analytic_factor_forward.h"

namespace plumbline {

/// Standard deviation of a surface's direction from its category [rad]. Weak, so that the returns
/// decide where surfaces are not at right angles.
constexpr double kShapeSigmaRad = 0.1;
/// Regions this close to parallel or orthogonal get a shape term [rad]: 10 degrees, as published.
constexpr double kShapeMarginRad = 0.17453292519943295;
/// Length of a surface region of a shape term [m]: the direction of a shorter one is noise.
constexpr double kShapeRegionM = 0.2;

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

/// Shape potential: the normal n of a segment of surface agrees with the normal n* of a segment of
/// an adjacent region up to a right angle R_k,
///   residual = (R_k^T n* - n) / sigma,
/// which is (n* - R_k n) / sigma turned by R_k^T: same length, same cost. Both are a SegmentNormal,
/// so that nothing changes when the whole map turns. Blocks: previous_point, current_point of the
/// segment, adjacent_previous, adjacent_current of the adjacent one, x, y [m] each, in the world.
/// Residual: 2, dimensionless. Derivatives are 2x2 row-major and may be null. Singular where a
/// segment has no length, d = previous - current = 0. With u = d / |d|,
///   dn/dprevious = (1/|d|) (I - n n^T) M = -(1/|d|) u n^T = -dn/dcurrent.
struct ShapeResidual {
  ShapeCategory category = ShapeCategory::k0;  ///< of n*, seen from n
  double inv_sigma = 1.0;                      ///< [1/rad]

  /// Returns false if a segment has no length or anything is not finite; the outputs then carry no
  /// meaning.
  bool Evaluate(const double* previous_point, const double* current_point,
                const double* adjacent_previous, const double* adjacent_current, double* residuals,
                double* d_previous, double* d_current, double* d_adjacent_previous,
                double* d_adjacent_current) const {
    Eigen::Vector2d normal, adjacent;
    Eigen::Matrix2d by_previous, by_adjacent;
    if (!Linearize(previous_point, current_point, &normal, &by_previous) ||
        !Linearize(adjacent_previous, adjacent_current, &adjacent, &by_adjacent)) {
      return false;
    }
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    residual = inv_sigma * (TurnBack(category, adjacent) - normal);
    by_previous *= -inv_sigma;
    by_adjacent *= inv_sigma;
    by_adjacent.col(0) = TurnBack(category, by_adjacent.col(0));
    by_adjacent.col(1) = TurnBack(category, by_adjacent.col(1));
    Store(by_previous, d_previous);
    Store(-by_previous, d_current);
    Store(by_adjacent, d_adjacent_previous);
    Store(-by_adjacent, d_adjacent_current);
    return residual.allFinite();
  }

 private:
  // Row by row; nowhere if that is null.
  static void Store(const Eigen::Matrix2d& derivative, double* values) {
    if (values == nullptr) return;
    for (int i = 0; i < 4; ++i) values[i] = derivative(i / 2, i % 2);
  }
  // The segment's normal, and its derivative by `previous`.
  static bool Linearize(const double* previous, const double* current, Eigen::Vector2d* normal,
                        Eigen::Matrix2d* by_previous) {
    const Eigen::Vector2d d(previous[0] - current[0], previous[1] - current[1]);
    const double squared_length = d.squaredNorm();
    if (!(squared_length >= std::numeric_limits<double>::min()) || !std::isfinite(squared_length)) {
      return false;
    }
    const double inv_length = 1.0 / std::sqrt(squared_length);
    const Eigen::Vector2d u = inv_length * d;
    *normal << -u.y(), u.x();
    *by_previous = -inv_length * u * normal->transpose();
    return true;
  }
};

using ShapeFactor = AnalyticFactor<ShapeResidual, 2, 2, 2, 2, 2>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_SHAPE_FACTOR_H_
