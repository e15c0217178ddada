#include "plumbline/solvers/front_end/surface_points.h"

#include <cstddef>

#include "plumbline/core/joined_returns.h"

namespace plumbline {

namespace {

// normal_of(return id): zero where there is no surface.
template <typename NormalOf>
void ThinNewScans(const SlamGraph& graph, const NormalOf& normal_of, double spacing_m,
                  ThreadPool* pool, std::vector<SurfacePoints>* surfaces) {
  const std::size_t first_scan = surfaces->size();
  surfaces->resize(graph.num_scans());
  const double spacing_squared = spacing_m * spacing_m;
  const auto thin_scan = [&](int s, std::vector<Eigen::Vector2d>* measured,
                             SurfacePoints* thinned) {
    MeasuredPoints(graph, s, measured);
    SurfacePoints& surface = *thinned;
    surface.clear();
    for (std::size_t k = 0; k < measured->size(); ++k) {
      const Eigen::Vector2d normal = normal_of(graph.scan(s).first_return + k);
      const Eigen::Vector2d& position = (*measured)[k];
      if (normal.isZero()) continue;
      if (!surface.empty() &&
          (position - surface.back().position).squaredNorm() < spacing_squared) {
        continue;
      }
      surface.push_back({position, normal});
    }
    (*surfaces)[s] = surface;  // a copy has no slack
  };
  constexpr std::size_t kScansPerChunk = 64;
  pool->ForEachChunk(surfaces->size() - first_scan, kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       std::vector<Eigen::Vector2d> measured;
                       SurfacePoints thinned;
                       for (std::size_t i = begin; i < end; ++i) {
                         thin_scan(static_cast<int>(first_scan + i), &measured, &thinned);
                       }
                     });
}

}  // namespace

std::vector<SurfacePoints> ThinnedSurfacePoints(const SlamGraph& graph,
                                                const std::vector<Eigen::Vector2f>& normals,
                                                double spacing_m, ThreadPool* pool) {
  std::vector<SurfacePoints> surfaces;
  const auto normal_of = [&](std::size_t r) -> Eigen::Vector2d {
    return normals[r].cast<double>();
  };
  ThinNewScans(graph, normal_of, spacing_m, pool, &surfaces);
  return surfaces;
}

void ExtendThinnedSurfacePoints(const SlamGraph& graph, const MeasuredSurface& measured,
                                double spacing_m, ThreadPool* pool,
                                std::vector<SurfacePoints>* surfaces) {
  const auto normal_of = [&](std::size_t r) { return measured.normals[r].Direction(); };
  ThinNewScans(graph, normal_of, spacing_m, pool, surfaces);
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
