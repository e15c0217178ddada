#ifndef PLUMBLINE_CORE_RETURN_NORMALS_H_
#define PLUMBLINE_CORE_RETURN_NORMALS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/core/return_normal.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// How surface normals are read off a single scan.
struct ReturnNormalOptions {
  /// Half length [m] of the stretch of surface that a normal is fitted to. In metres, not beams,
  /// so that close surfaces do not get their normals from range noise: six times the range noise
  /// and more.
  double half_window_m = 0.08;

  bool Check(std::string* error) const;
};

/// Estimates one unit surface normal per return of the graph, in the frame of its robot, turned
/// towards the laser. The zero vector marks a return without a surface around it: isolated, at a
/// range jump, or round.
///
/// Total least squares over the neighbours along the scan that lie within the window and are
/// joined to the return without a range jump.
std::vector<Eigen::Vector2f> EstimateReturnNormals(const SlamGraph& graph,
                                                   const ReturnNormalOptions& options,
                                                   ThreadPool* pool);

/// Adds the normals of the scans from first_scan on to those of the scans before it, in 16 bits.
void ExtendReturnNormals(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                         ThreadPool* pool, std::vector<ReturnNormal>* normals);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_RETURN_NORMALS_H_
