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

std::vector<SurfacePoints> ThinnedSurfacePoints(const SlamGraph& graph,
                                                const MeasuredSurface& measured, double spacing_m,
                                                ThreadPool* pool) {
  constexpr std::size_t kScansPerChunk = 64;
  std::vector<SurfacePoints> surfaces(graph.num_scans());
  pool->ForEachChunk(
      surfaces.size(), kScansPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
          surfaces[s] = ThinnedSurfaceOf(graph, static_cast<int>(s), measured, spacing_m);
        }
      });
  return surfaces;
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

std::vector<int> MatchedScanOfPoses(const SlamGraph& graph,
                                    const std::vector<SurfacePoints>& surfaces) {
  std::vector<int> scan_of_pose(graph.num_poses(), -1);
  for (int s = graph.num_scans() - 1; s >= 0; --s) {
    if (!surfaces[s].empty()) scan_of_pose[graph.scan(s).pose] = s;
  }
  return scan_of_pose;
}

}  // namespace plumbline
