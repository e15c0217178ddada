#include "plumbline/core/measured_surface.h"

#include <cstddef>
#include <utility>

#include "plumbline/core/joined_returns.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

MeasuredSurface MeasureSurface(const SlamGraph& graph, const ReturnNormalOptions& options,
                               ThreadPool* pool) {
  return MeasureSurface(graph, EstimateReturnNormals(graph, options, pool), pool);
}

MeasuredSurface MeasureSurface(const SlamGraph& graph, std::vector<Eigen::Vector2f> normals,
                               ThreadPool* pool) {
  MeasuredSurface surface;
  surface.points.resize(graph.num_returns());
  surface.normals = std::move(normals);
  constexpr std::size_t kScansPerChunk = 64;
  pool->ForEachChunk(graph.num_scans(), kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       std::vector<Eigen::Vector2d> points;
                       for (std::size_t s = begin; s < end; ++s) {
                         MeasuredPoints(graph, static_cast<int>(s), &points);
                         const std::size_t first = graph.scan(static_cast<int>(s)).first_return;
                         for (std::size_t k = 0; k < points.size(); ++k) {
                           surface.points[first + k] = points[k].cast<float>();
                         }
                       }
                     });
  return surface;
}

}  // namespace plumbline
