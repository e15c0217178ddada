#ifndef PLUMBLINE_CORE_RETURN_NORMALS_H_
#define PLUMBLINE_CORE_RETURN_NORMALS_H_

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

/// Estimates one surface normal per return of the scans from first_scan on, in the frame of its
/// robot, turned towards the laser, and adds them to those of the scans before. None where a return
/// has no surface around it: isolated, at a range jump, or round; nor of what moves.
///
/// Total least squares over the neighbours along the scan that lie within the window and are
/// joined to the return without a range jump.
void ExtendReturnNormals(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                         ThreadPool* pool, std::vector<ReturnNormal>* normals);

/// Takes the normals of returns that are known to move (SlamGraph::Moves) by now.
void DropMovingNormals(const SlamGraph& graph, std::vector<ReturnNormal>* normals);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_RETURN_NORMALS_H_
