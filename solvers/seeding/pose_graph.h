#ifndef PLUMBLINE_SOLVERS_SEEDING_POSE_GRAPH_H_
#define PLUMBLINE_SOLVERS_SEEDING_POSE_GRAPH_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Moves the poses to the optimum of the edges: `sequential` ones as they are, `closures` under a
/// Cauchy loss. Edges name poses by their index; the first pose stays.
void OptimizePoseGraph(const std::vector<RelativePoseConstraint>& sequential,
                       const std::vector<RelativePoseConstraint>& closures,
                       std::vector<Pose2>* world_from_pose);

/// Squared Mahalanobis length of an edge's error, chi-squared with three degrees of freedom.
double EdgeChi2(const RelativePoseConstraint& edge, const std::vector<Pose2>& world_from_pose);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_POSE_GRAPH_H_
