#include "plumbline/solvers/hypotheses/suspect_clusters.h"

#include <algorithm>
#include <cstddef>

#include "plumbline/solvers/loop_closure/closure_clusters.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

// Tuned on mit-killian, infinite-corridor, acapulco and fr-clinic.

// Clusters that are suspected at a time: the worst by the conflicts around them, and by how much
// they strain the graph.
constexpr std::size_t kMostByConflict = 8;
constexpr std::size_t kMostByStrain = 4;
// A wrong cluster bends what lies within this much path [m] of it the most.
constexpr double kAroundM = 15.0;

// Sums over the path of the conflicting returns beyond the explicable ones, with other passes.
class ExcessAlongPath {
 public:
  ExcessAlongPath(const std::vector<Keyframe>& keyframes, const MapConsistency& consistency,
                  double explicable_share) {
    double sum = 0.0;
    std::size_t key = 0;
    for (const ViewpointConflict& viewpoint : consistency.viewpoints) {
      while (key + 1 < keyframes.size() && keyframes[key + 1].pose <= viewpoint.pose) ++key;
      sum += viewpoint.between_passes.num_conflicting -
             explicable_share * viewpoint.between_passes.num_compared;
      path_m_.push_back(keyframes[key].path_m);
      sum_.push_back(sum);
    }
  }

  double Between(double low_m, double high_m) const { return UpTo(high_m) - UpTo(low_m); }

 private:
  double UpTo(double path_m) const {
    const auto end = std::upper_bound(path_m_.begin(), path_m_.end(), path_m);
    return end == path_m_.begin() ? 0.0 : sum_[end - path_m_.begin() - 1];
  }

  std::vector<double> path_m_, sum_;  // up to each viewpoint, in order of the path
};

// Mean squared error of a cluster's closures, beyond what chance makes of it.
double Strain(const ClosureCluster& cluster, const KeyframeGraph& keys) {
  constexpr double kByChance = 3.0;  // degrees of freedom
  double sum = 0.0;
  for (const int c : cluster) sum += EdgeChi2(keys.closures[c], keys.world_from_key);
  return sum / static_cast<double>(cluster.size()) - kByChance;
}

}  // namespace

std::vector<std::vector<RelativePoseConstraint>> SuspectClusters(const KeyframeGraph& keys,
                                                                 const MapConsistency& consistency,
                                                                 double explicable_share) {
  const std::vector<ClosureCluster> clusters = FindClosureClusters(keys.closures, keys);
  std::vector<double> conflict(clusters.size()), strain(clusters.size());
  const ExcessAlongPath excess(keys.keyframes, consistency, explicable_share);
  // A cluster is in order of the path of its later ends.
  const auto later_m = [&](int closure) {
    return keys.keyframes[keys.closures[closure].to].path_m;
  };
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    conflict[i] = excess.Between(later_m(clusters[i].front()) - kAroundM,
                                 later_m(clusters[i].back()) + kAroundM);
    strain[i] = Strain(clusters[i], keys);
  }
  std::vector<std::vector<RelativePoseConstraint>> suspects;
  std::vector<bool> taken(clusters.size(), false);
  const auto take = [&](const std::vector<double>& suspicion, std::size_t most) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      if (!taken[i] && suspicion[i] > 0.0) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return suspicion[a] > suspicion[b]; });
    if (order.size() > most) order.resize(most);
    for (const std::size_t i : order) {
      taken[i] = true;
      suspects.emplace_back();
      for (const int c : clusters[i]) suspects.back().push_back(keys.closures[c]);
    }
  };
  take(conflict, kMostByConflict);
  take(strain, kMostByStrain);
  return suspects;
}

}  // namespace plumbline
