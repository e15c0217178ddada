#ifndef PLUMBLINE_CORE_LINE_FIT_H_
#define PLUMBLINE_CORE_LINE_FIT_H_

#include <Eigen/Core>

namespace plumbline {

/// Sums of weighted points of the plane from which centroid and covariance follow; sums of
/// disjoint sets add. Give points relative to a near-by origin: the covariance is a difference of
/// two sums and loses digits when the points are far from it.
struct PointMoments {
  double weight = 0.0;
  double x = 0.0, y = 0.0;              ///< first moments [m]
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< second moments [m^2]

  void Add(double px, double py, double w = 1.0) {
    weight += w;
    x += w * px;
    y += w * py;
    xx += w * px * px;
    xy += w * px * py;
    yy += w * py * py;
  }
  PointMoments& operator+=(const PointMoments& other) {
    weight += other.weight;
    x += other.x;
    y += other.y;
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    return *this;
  }

  /// Of the same points about an origin moved by (-dx, -dy) [m].
  PointMoments Shifted(double dx, double dy) const {
    return {weight,
            x + dx * weight,
            y + dy * weight,
            xx + (2.0 * dx * x + dx * dx * weight),
            xy + (dx * y + dy * x + dx * dy * weight),
            yy + (2.0 * dy * y + dy * dy * weight)};
  }
};

/// Points are line-like up to this ratio of the smaller to the larger variance: a stretch of
/// surface is at least 2.6 times as long as it is thick.
constexpr double kMaxEigenvalueRatio = 0.15;

/// Total-least-squares line through a point set: all points q with normal . (q - centroid) = 0.
struct LineFit {
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();   ///< unit; its sign is arbitrary
  double smaller_eigenvalue = 0.0;                     ///< variance across the line [m^2]
  double larger_eigenvalue = 0.0;                      ///< variance along the line [m^2]

  /// Smaller over larger eigenvalue: 0 for a perfect line, 1 for a round blob or a single point.
  double EigenvalueRatio() const {
    return larger_eigenvalue > 0.0 ? smaller_eigenvalue / larger_eigenvalue : 1.0;
  }
};

/// Fits the line by principal component analysis. Needs moments.weight > 0.
LineFit FitLine(const PointMoments& moments);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_LINE_FIT_H_
