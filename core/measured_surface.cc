#include "plumbline/core/measured_surface.h"

#include <cstddef>

#include "plumbline/core/return_normals.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

MeasuredSurface MeasureSurface(const SlamGraph& graph, const ReturnNormalOptions& options,
                               ThreadPool* pool) {
  MeasuredSurface surface;
  ExtendSurface(graph, 0, options, pool, &surface);
  return surface;
}

MeasuredSurface SurfaceOfNormals(const std::vector<Eigen::Vector2f>& normals, ThreadPool* pool) {
  MeasuredSurface surface;
  surface.normals.resize(normals.size());
  constexpr std::size_t kReturnsPerChunk = 16384;
  pool->ForEachChunk(normals.size(), kReturnsPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t r = begin; r < end; ++r) {
                         surface.normals[r] = ReturnNormal(normals[r].cast<double>());
                       }
                     });
  return surface;
}

void ExtendSurface(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                   ThreadPool* pool, MeasuredSurface* surface) {
  ExtendReturnNormals(graph, first_scan, options, pool, &surface->normals);
}

}  // namespace plumbline
