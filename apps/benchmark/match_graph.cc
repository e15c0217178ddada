#include "plumbline/apps/benchmark/match_graph.h"

namespace plumbline {

MatchGraph BuildMatchGraph(const PlainIcp& scans, const MatchGraphOptions& options) {
  MatchGraph result;
  result.edges = scans.MatchConsecutive(options.icp);
  result.chain = ChainEdges(scans.graph(), result.edges);
  const int num_poses = static_cast<int>(result.chain.size());
  for (int from = 0; from < num_poses; ++from) {
    for (int to = from + 2; to < num_poses; ++to) {
      const Pose2 guess = Between(result.chain[from], result.chain[to]);
      if (guess.translation().norm() > options.radius_m) continue;
      const PlainMatch match = scans.Match(from, to, guess, options.icp);
      if (!match.converged || match.matched_ratio < options.min_matched_ratio) continue;
      result.edges.push_back({from, to, match.from_from_to, match.covariance});
    }
  }
  return result;
}

}  // namespace plumbline
