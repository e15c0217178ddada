#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

PackedSurface::PackedSurface(const SurfacePoints& points) {
  points_.reserve(points.size());
  for (const SurfacePoint& point : points) {
    points_.push_back({point.position.cast<float>(), point.normal.cast<float>()});
  }
}

SurfacePoints PackedSurface::Unpacked() const {
  SurfacePoints points;
  points.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) points.push_back((*this)[i]);
  return points;
}

std::vector<PackedSurface> Packed(const std::vector<SurfacePoints>& surfaces) {
  return {surfaces.begin(), surfaces.end()};
}

SurfacePoints ThinnedSurfaceOf(const SlamGraph& graph, int scan, const MeasuredSurface& measured,
                               double spacing_m) {
  const double spacing_squared = spacing_m * spacing_m;
  const ScanReturns returns = graph.ReturnsOfScan(scan);
  const std::size_t first = graph.scan(scan).first_return;
  SurfacePoints surface;
  surface.reserve(graph.scan(scan).num_returns);
  for (std::size_t r = first; r < first + graph.scan(scan).num_returns; ++r) {
    if (measured.normals[r].IsNone()) continue;
    const Eigen::Vector2d position = returns.PointInRobot(r);
    if (!surface.empty() && (position - surface.back().position).squaredNorm() < spacing_squared) {
      continue;
    }
    surface.push_back({position, measured.normals[r].Direction()});
  }
  surface.shrink_to_fit();
  return surface;
}

}  // namespace plumbline
