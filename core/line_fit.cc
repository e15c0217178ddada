#include "plumbline/core/line_fit.h"

#include <algorithm>
#include <cmath>

#include "plumbline/core/pose_frame.h"

namespace plumbline {
namespace {

// The unit vector at half the angle of (x, y), of length `radius`: the direction of a line whose
// covariance has x = (cxx - cyy) / 2 and y = cxy. By the sum, where the difference would cancel.
Eigen::Vector2d HalfAngle(double x, double y, double radius) {
  if (!(radius > 0.0)) return Eigen::Vector2d::UnitX();
  const double larger = std::sqrt(0.5 * (radius + std::abs(x)) / radius);
  const double smaller = std::abs(y) / (2.0 * radius * larger);
  return {x >= 0.0 ? larger : smaller, std::copysign(x >= 0.0 ? smaller : larger, y)};
}

}  // namespace

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
  const double radius = std::sqrt(half_difference * half_difference + cxy * cxy);
  fit.larger_eigenvalue = half_trace + radius;
  fit.smaller_eigenvalue = std::max(0.0, half_trace - radius);
  fit.normal = TurnedLeft(HalfAngle(half_difference, cxy, radius));
  return fit;
}

}  // namespace plumbline
