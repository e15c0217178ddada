#ifndef PLUMBLINE_SOLVERS_FRONT_END_SURFACE_POINTS_H_
#define PLUMBLINE_SOLVERS_FRONT_END_SURFACE_POINTS_H_

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// A point on a surface with the surface's unit normal, in one frame. [m]
struct SurfacePoint {
  Eigen::Vector2d position;
  Eigen::Vector2d normal;
};
using SurfacePoints = std::vector<SurfacePoint>;

/// The surface points of a scan, in the frame of its robot, where many of them are kept: in single
/// precision, like the ranges, which takes half the memory.
class PackedSurface {
 public:
  PackedSurface() = default;
  explicit PackedSurface(const SurfacePoints& points);

  std::size_t size() const { return points_.size(); }
  bool empty() const { return points_.empty(); }
  SurfacePoint operator[](std::size_t i) const {
    return {points_[i].position.cast<double>(), points_[i].normal.cast<double>()};
  }
  SurfacePoints Unpacked() const;

 private:
  struct Point {
    Eigen::Vector2f position, normal;
  };
  std::vector<Point> points_;
};

/// The packed surfaces of scans.
std::vector<PackedSurface> Packed(const std::vector<SurfacePoints>& surfaces);

/// A change of frame with its sine and cosine taken once, for many points.
class FrameChange {
 public:
  explicit FrameChange(const Pose2& a_from_b) : translation_(a_from_b.translation()) {
    const double c = std::cos(a_from_b.yaw), s = std::sin(a_from_b.yaw);
    rotation_ << c, -s, s, c;
  }

  SurfacePoint operator*(const SurfacePoint& in_b) const {
    return {rotation_ * in_b.position + translation_, rotation_ * in_b.normal};
  }

 private:
  Eigen::Matrix2d rotation_;
  Eigen::Vector2d translation_;
};

inline SurfacePoint operator*(const Pose2& a_from_b, const SurfacePoint& in_b) {
  return FrameChange(a_from_b) * in_b;
}

/// Scan matching takes one point per this length of surface [m], about as dense as the beams of a
/// laser with a step of half a degree at 3.5 m.
constexpr double kPointSpacingM = 0.03;

/// The surface points of a scan in the frame of its robot, thinned to one per `spacing_m` of
/// surface: scan matching gains nothing from two beams a millimetre apart.
SurfacePoints ThinnedSurfaceOf(const SlamGraph& graph, int scan, const MeasuredSurface& measured,
                               double spacing_m);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_SURFACE_POINTS_H_
