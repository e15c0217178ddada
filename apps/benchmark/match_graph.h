#ifndef PLUMBLINE_APPS_BENCHMARK_MATCH_GRAPH_H_
#define PLUMBLINE_APPS_BENCHMARK_MATCH_GRAPH_H_

#include <vector>

#include "plumbline/apps/benchmark/plain_icp.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

struct MatchGraphOptions {
  /// At this gate, the errors of SGD over the edges are near the figures of the published paper.
  PlainIcpOptions icp{0.5};
  /// Largest distance [m] between the poses of two scans that are matched with each other.
  double radius_m = 5.0;
  /// Smallest share of matched returns of such a match: the scans see the same surfaces.
  double min_matched_ratio = 0.5;
};

/// The pose graph of a drive, for back ends to be compared on.
struct MatchGraph {
  std::vector<Pose2> chain;                   ///< the poses by consecutive matches alone
  std::vector<RelativePoseConstraint> edges;  ///< consecutive ones first, then loop closures
};

/// Matches consecutive scans, and by the chain of these matches all other pairs of scans that are
/// near each other. No closure is tested against the others.
MatchGraph BuildMatchGraph(const PlainIcp& scans, const MatchGraphOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_MATCH_GRAPH_H_
