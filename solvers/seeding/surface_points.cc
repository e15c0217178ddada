#include "plumbline/solvers/seeding/surface_points.h"

#include <cstddef>

namespace plumbline {

std::vector<SurfacePoints> ThinnedSurfacePoints(const SlamGraph& graph,
                                                const std::vector<Eigen::Vector2f>& normals,
                                                double spacing_m, ThreadPool* pool) {
  std::vector<SurfacePoints> surfaces(graph.num_scans());
  const double spacing_squared = spacing_m * spacing_m;
  const auto thin_scan = [&](std::size_t s) {
    const ScanEntry& scan = graph.scan(static_cast<int>(s));
    SurfacePoints& surface = surfaces[s];
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (normals[r].isZero()) continue;
      const Eigen::Vector2d position = graph.PointInRobot(r);
      if (!surface.empty() &&
          (position - surface.back().position).squaredNorm() < spacing_squared) {
        continue;
      }
      surface.push_back({position, normals[r].cast<double>()});
    }
  };
  constexpr std::size_t kScansPerChunk = 64;
  pool->ForEachChunk(surfaces.size(), kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) thin_scan(s);
                     });
  return surfaces;
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
