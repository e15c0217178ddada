#ifndef PLUMBLINE_CORE_MEASURED_SURFACE_H_
#define PLUMBLINE_CORE_MEASURED_SURFACE_H_

#include <vector>

#include "plumbline/core/return_normal.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

class ThreadPool;
struct ReturnNormalOptions;

/// What the scans saw of the surfaces, per return and in the frame of its robot: fixed while poses
/// move. Where the beams ended the graph knows, ScanReturns::PointInRobot; a copy would be twice
/// what every pass over the returns has to read.
struct MeasuredSurface {
  std::vector<ReturnNormal> normals;  ///< see ExtendReturnNormals
};

/// Estimates the normals.
MeasuredSurface MeasureSurface(const SlamGraph& graph, const ReturnNormalOptions& options,
                               ThreadPool* pool);

/// Adds the scans from first_scan on to the surface of the scans before it.
void ExtendSurface(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                   ThreadPool* pool, MeasuredSurface* surface);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MEASURED_SURFACE_H_
