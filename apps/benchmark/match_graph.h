#ifndef PLUMBLINE_APPS_BENCHMARK_MATCH_GRAPH_H_
#define PLUMBLINE_APPS_BENCHMARK_MATCH_GRAPH_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/pairwise_icp.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

struct MatchGraphOptions {
  PairwiseIcpOptions icp;
  /// Scans are matched with each other if they are taken this close together [m].
  double radius_m = 5.0;
  /// They see enough of each other if this share of the one's points lies on the other.
  double min_inlier_ratio = 0.5;
  /// Matches are searched and the graph optimised so many times: better poses find more of them.
  int rounds = 3;
  /// In the end, matches off the others by more are dropped: chi-squared with three degrees of
  /// freedom, which 99.9 % of the right ones stay below.
  double max_chi2 = 16.3;
};

/// What the front end of a graph-based mapper makes of a drive, for back ends to be compared on.
struct MatchGraph {
  std::vector<Pose2> chain;                   ///< the poses by consecutive matches alone
  std::vector<RelativePoseConstraint> edges;  ///< consecutive ones first, then closures
};

/// Matches consecutive scans, and all pairs of scans that are near each other; the latter have to
/// agree with the rest. Where a consecutive match fails, the odometry takes its place. One scan per
/// pose, in order of time, joined by odometry. surfaces: per scan.
MatchGraph BuildMatchGraph(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                           const MotionOptions& motion, const MatchGraphOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_MATCH_GRAPH_H_
