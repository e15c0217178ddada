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

void ExtendSurface(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                   ThreadPool* pool, MeasuredSurface* surface) {
  ExtendReturnNormals(graph, first_scan, options, pool, &surface->normals);
}

}  // namespace plumbline
