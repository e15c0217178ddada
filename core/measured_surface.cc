#include "plumbline/core/measured_surface.h"

#include <cstddef>
#include <utility>

#include "plumbline/core/joined_returns.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {
namespace {

void PlacePoints(const SlamGraph& graph, int first_scan, ThreadPool* pool,
                 std::vector<Eigen::Vector2f>* surface_points) {
  surface_points->resize(graph.num_returns());
  constexpr std::size_t kScansPerChunk = 64;
  pool->ForEachChunk(graph.num_scans() - first_scan, kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       std::vector<Eigen::Vector2d> points;
                       for (std::size_t i = begin; i < end; ++i) {
                         const int s = first_scan + static_cast<int>(i);
                         MeasuredPoints(graph, s, &points);
                         const std::size_t first = graph.scan(s).first_return;
                         for (std::size_t k = 0; k < points.size(); ++k) {
                           (*surface_points)[first + k] = points[k].cast<float>();
                         }
                       }
                     });
}

}  // namespace

MeasuredSurface MeasureSurface(const SlamGraph& graph, const ReturnNormalOptions& options,
                               ThreadPool* pool) {
  return MeasureSurface(graph, EstimateReturnNormals(graph, options, pool), pool);
}

MeasuredSurface MeasureSurface(const SlamGraph& graph, std::vector<Eigen::Vector2f> normals,
                               ThreadPool* pool) {
  MeasuredSurface surface;
  surface.normals = std::move(normals);
  PlacePoints(graph, 0, pool, &surface.points);
  return surface;
}

void ExtendSurface(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                   ThreadPool* pool, MeasuredSurface* surface) {
  ExtendReturnNormals(graph, first_scan, options, pool, &surface->normals);
  PlacePoints(graph, first_scan, pool, &surface->points);
}

}  // namespace plumbline
