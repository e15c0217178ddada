#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_EDGES_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_EDGES_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/acceptance.h"

namespace plumbline {

/// A relative pose that the scans of its two poses contradict.
struct ContradictedEdge {
  std::size_t edge = 0;  ///< index into SlamGraph::relative_poses()
  /// What the scans say in its place, if they fit each other well somewhere near.
  std::optional<RelativePoseConstraint> match;
};

/// Finds the relative poses that their own scans contradict, wherever the poses of the graph are:
///
/// - the two scans match each other, beginning at the edge, and the match is off it by more than
///   both covariances explain (chi-squared 16.3, which one sound edge in a thousand exceeds), or
/// - at the edge, one side shows surfaces where the other looked through: more than loop closure
///   lets pass (LoopAcceptance::kMaxFreeSpaceConflict), and more than three times what is usual
///   from one scan to the next, as in a crowd. Each side is three scans, a metre of path apart: two
///   corridors look alike in a single one. Between consecutive poses this counts only if there is a
///   match in the edge's place, for something has to hold the drive together.
///
/// A match has to have loop closure's share of inliers and no such conflict. Edges whose scans have
/// too little in common, or of poses without scans, are not contradicted. In order of the edges.
/// The result does not depend on the number of threads.
std::vector<ContradictedEdge> FindContradictedEdges(const SlamGraph& graph,
                                                    const MeasuredSurface& surface,
                                                    const RangeBeamOptions& beam, ThreadPool* pool);

/// What is said of them in a summary. poses: (x, y, yaw) each.
std::vector<IgnoredEdge> DescribeIgnored(const std::vector<ContradictedEdge>& contradicted,
                                         const SlamGraph& graph, const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_CONTRADICTED_EDGES_H_
