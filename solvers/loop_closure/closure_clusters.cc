#include "plumbline/solvers/loop_closure/closure_clusters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {

std::vector<ClosureCluster> FindClosureClusters(const std::vector<RelativePoseConstraint>& closures,
                                                const KeyframeGraph& keys) {
  std::vector<int> order(closures.size());
  std::iota(order.begin(), order.end(), 0);
  const auto path_m = [&](int closure) { return keys.keyframes[closures[closure].to].path_m; };
  const auto place = [&](int closure) -> Eigen::Vector2d {
    return keys.world_from_key[closures[closure].from].translation();
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return path_m(a) < path_m(b); });
  std::vector<ClosureCluster> clusters;
  std::size_t first_open = 0;  // the clusters before this one begin too far back
  for (const int closure : order) {
    while (first_open < clusters.size() &&
           path_m(closure) - path_m(clusters[first_open].front()) > LoopAcceptance::kClusterPathM) {
      ++first_open;
    }
    const auto joined = std::find_if(clusters.begin() + static_cast<std::ptrdiff_t>(first_open),
                                     clusters.end(), [&](const ClosureCluster& cluster) {
                                       return (place(cluster.front()) - place(closure)).norm() <
                                              LoopAcceptance::kClusterPlaceM;
                                     });
    if (joined != clusters.end()) {
      joined->push_back(closure);
    } else {
      clusters.push_back({closure});
    }
  }
  return clusters;
}

bool RepeatsOneOf(const RelativePoseConstraint& closure,
                  const std::vector<RelativePoseConstraint>& others, const KeyframeGraph& keys) {
  const auto pose = [&](int key) { return keys.world_from_key[key]; };
  const auto says_the_same = [&](const RelativePoseConstraint& other) {
    const double apart_m =
        std::abs(keys.keyframes[closure.to].path_m - keys.keyframes[other.to].path_m);
    if (apart_m > LoopAcceptance::kClusterPathM) return false;
    // Where the other one puts the later keyframe of this one.
    const Pose2 by_other =
        pose(other.from) * other.from_from_to * Between(pose(other.to), pose(closure.to));
    const Pose2 off = Between(by_other, pose(closure.from) * closure.from_from_to);
    return std::hypot(off.x, off.y) < LoopAcceptance::kSameClosureM &&
           std::abs(off.yaw) < LoopAcceptance::kSameClosureRad;
  };
  return std::any_of(others.begin(), others.end(), says_the_same);
}

std::vector<RelativePoseConstraint> WithoutRepetitions(
    const std::vector<RelativePoseConstraint>& closures, std::size_t most,
    const KeyframeGraph& keys) {
  std::vector<RelativePoseConstraint> kept;
  for (const RelativePoseConstraint& closure : closures) {
    if (kept.size() == most) break;
    if (!RepeatsOneOf(closure, kept, keys)) kept.push_back(closure);
  }
  return kept;
}

}  // namespace plumbline
