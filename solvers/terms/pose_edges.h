#ifndef PLUMBLINE_SOLVERS_TERMS_POSE_EDGES_H_
#define PLUMBLINE_SOLVERS_TERMS_POSE_EDGES_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/relative_pose_factor.h"

namespace plumbline {

/// A residual between two poses of a graph.
struct PoseEdge {
  int from = 0;
  int to = 0;
  RelativePoseResidual residual;
};

/// The residual of a single constraint.
PoseEdge MotionEdge(const OdometryConstraint& constraint, const MotionOptions& options);
PoseEdge RelativePoseEdge(const RelativePoseConstraint& constraint);

/// The residuals of a graph's odometry and relative poses.
struct PoseEdges {
  PoseEdges(const SlamGraph& graph, const FactorOptions& options);

  std::vector<PoseEdge> motions;
  std::vector<PoseEdge> relative_poses;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_POSE_EDGES_H_
