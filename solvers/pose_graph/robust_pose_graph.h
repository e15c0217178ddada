#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_ROBUST_POSE_GRAPH_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_ROBUST_POSE_GRAPH_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Moves the poses to the optimum of a pose graph with outliers: `certain` edges count as they are,
/// `uncertain` ones under a Cauchy loss of three standard deviations. The loss begins wide enough
/// for every edge and narrows step by step (graduated non-convexity: Blake & Zisserman, Visual
/// Reconstruction, 1987; Yang et al., Graduated non-convexity for robust spatial perception, 2020).
/// Each step is one of Gauss-Newton with iteratively re-weighted edges, solved by a sparse Cholesky
/// factorisation whose symbolic part is shared by all steps: some ten times faster than a general
/// solver where the graph is optimised again and again as edges come and go.
///
/// Pose 0 stays. All edges together must tie the poses together; edges whose covariance is not
/// positive definite do not count. Of the steps at the final width the best poses are kept; they
/// stay as they were if a system cannot be solved. Deterministic; one thread.
void OptimizeRobustly(const std::vector<RelativePoseConstraint>& certain,
                      const std::vector<RelativePoseConstraint>& uncertain,
                      std::vector<Pose2>* world_from_pose);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_ROBUST_POSE_GRAPH_H_
