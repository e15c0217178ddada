#include "plumbline/core/line_fit.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

PointMoments& PointMoments::operator+=(const PointMoments& other) {
  weight += other.weight;
  x += other.x;
  y += other.y;
  xx += other.xx;
  xy += other.xy;
  yy += other.yy;
  return *this;
}

PointMoments PointMoments::Shifted(double dx, double dy) const {
  PointMoments shifted = *this;
  shifted.x += dx * weight;
  shifted.y += dy * weight;
  shifted.xx += 2.0 * dx * x + dx * dx * weight;
  shifted.xy += dx * y + dy * x + dx * dy * weight;
  shifted.yy += 2.0 * dy * y + dy * dy * weight;
  return shifted;
}

LineFit FitLine(const PointMoments& moments) {
  LineFit fit;
  const double inverse = 1.0 / moments.weight;
  const double mx = moments.x * inverse, my = moments.y * inverse;
  const double cxx = std::max(0.0, moments.xx * inverse - mx * mx);
  const double cyy = std::max(0.0, moments.yy * inverse - my * my);
  const double cxy = moments.xy * inverse - mx * my;
  fit.centroid = {mx, my};
  const double half_trace = 0.5 * (cxx + cyy);
  const double half_difference = 0.5 * (cxx - cyy);
  const double radius = std::hypot(half_difference, cxy);
  fit.larger_eigenvalue = half_trace + radius;
  fit.smaller_eigenvalue = std::max(0.0, half_trace - radius);
  // Half-angle form: the line's direction is at half the angle of (cxx - cyy, 2 cxy).
  const double direction = 0.5 * std::atan2(cxy, half_difference);
  fit.normal = {-std::sin(direction), std::cos(direction)};
  return fit;
}

}  // namespace plumbline
