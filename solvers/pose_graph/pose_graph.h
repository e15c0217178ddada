#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_GRAPH_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_GRAPH_H_

#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// How the optimisation of a pose graph ended.
struct PoseGraphResult {
  int iterations = 0;       ///< done
  bool converged = false;   ///< by its tolerance, not by the limit on iterations
  bool stopped = false;     ///< by the callback
  std::string stop_reason;  ///< for reports
  /// Of the Gauss-Newton optimisation: half the squared error (under the loss) at the start and
  /// after each iteration.
  std::vector<double> costs;
};

/// Called with the cost, as in PoseGraphResult::costs, and the poses after each iteration; false
/// asks to stop with the best poses so far.
using PoseGraphCallback =
    std::function<bool(double cost, const std::vector<Pose2>& world_from_pose)>;

/// Moves the poses to the optimum of the edges: `edges` as they are, `uncertain_edges` under a
/// Cauchy loss. Edges name poses by their index; the `fixed` ones stay. Poses without edges stay,
/// and so do all if the error cannot be evaluated.
PoseGraphResult OptimizePoseGraph(const std::vector<RelativePoseConstraint>& edges,
                                  const std::vector<RelativePoseConstraint>& uncertain_edges,
                                  std::vector<Pose2>* world_from_pose,
                                  const std::vector<int>& fixed = {0},
                                  const PoseGraphCallback& callback = nullptr);

/// Squared Mahalanobis length of an edge's error, chi-squared with three degrees of freedom.
double EdgeChi2(const RelativePoseConstraint& edge, const Pose2& world_from_from,
                const Pose2& world_from_to);
double EdgeChi2(const RelativePoseConstraint& edge, const std::vector<Pose2>& world_from_pose);

/// Standard deviation of an edge's position in the direction in which it is known worst [m].
double WorstSigmaM(const RelativePoseConstraint& edge);

/// The sum of EdgeChi2 over all edges.
double GraphChi2(const std::vector<RelativePoseConstraint>& edges,
                 const std::vector<Pose2>& world_from_pose);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_GRAPH_H_
