#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_STOCHASTIC_DESCENT_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_STOCHASTIC_DESCENT_H_

#include <functional>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {

/// Iterations of DescendStochastically, at most; each goes through all edges once. By then steps
/// are 1/400 of their first size.
constexpr int kMaxDescentIterations = 400;

/// Called with the poses after each iteration, counted from 1; false stops. May be empty.
using DescentCallback =
    std::function<bool(int iteration, const std::vector<Pose2>& world_from_pose)>;

/// Moves the poses down the error of the edges, one edge at a time. Robust against poor starts,
/// quick to find the shape; chi2 may rise for a while, and the end is near the optimum, not at it:
/// an edge's share of the steps goes by the mean M between its ends.
///
/// The state is the differences of consecutive poses in x, y and yaw, all in world axes. An edge
/// from a to b of information W (in world axes) asks for a change r of the pose b; it gets
///   beta = n 2 W r / (gamma t), never more than r,
/// n: differences between a and b, t: the iteration, gamma: the smallest diagonal of any W. The
/// differences share beta in proportion to 1 / M, M ~ diag(J^T W J) being what all edges across a
/// difference know of it. With sums in a tree an iteration takes O(edges log poses). Source: Olson,
/// Leonard, Teller: Fast iterative alignment of pose graphs with poor initial estimates (2006).
///
/// Edges name poses by index; an iteration takes them in random order, the same in every run. Every
/// group of connected poses is a chain by index, hung on its `fixed` poses, which stay, or else on
/// its first one; consecutive poses need no edge between them, but converge fast only if few edges
/// are long. Edges without a positive definite covariance are left out; poses without edges stay,
/// and so do all if the numbers leave the range of a double.
PoseGraphResult DescendStochastically(const std::vector<RelativePoseConstraint>& edges,
                                      std::vector<Pose2>* world_from_pose,
                                      const std::vector<int>& fixed = {0},
                                      const DescentCallback& callback = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_STOCHASTIC_DESCENT_H_
