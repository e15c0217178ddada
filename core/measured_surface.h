#ifndef PLUMBLINE_CORE_MEASURED_SURFACE_H_
#define PLUMBLINE_CORE_MEASURED_SURFACE_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

class ThreadPool;
struct ReturnNormalOptions;

/// What the scans saw of the surfaces, per return and in the frame of its robot: fixed while poses
/// move. Single precision is exact to 4 micrometres at 80 m, and halves the memory that every pass
/// over the returns has to read.
struct MeasuredSurface {
  std::vector<Eigen::Vector2f> points;   ///< measured end of the beam [m]
  std::vector<Eigen::Vector2f> normals;  ///< as EstimateReturnNormals gives them
};

/// Estimates the normals and places both in the frames of their robots.
MeasuredSurface MeasureSurface(const SlamGraph& graph, const ReturnNormalOptions& options,
                               ThreadPool* pool);

/// The same with normals that are already known; one per return.
MeasuredSurface MeasureSurface(const SlamGraph& graph, std::vector<Eigen::Vector2f> normals,
                               ThreadPool* pool);

/// Adds the scans from first_scan on to the surface of the scans before it.
void ExtendSurface(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                   ThreadPool* pool, MeasuredSurface* surface);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MEASURED_SURFACE_H_
