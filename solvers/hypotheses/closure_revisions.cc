#include "plumbline/solvers/hypotheses/closure_revisions.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/closure_clusters.h"

namespace plumbline {
namespace {

bool IsIn(const Revision& cluster, const RelativePoseConstraint& closure) {
  return std::any_of(cluster.begin(), cluster.end(), [&](const RelativePoseConstraint& other) {
    return other.from == closure.from && other.to == closure.to;
  });
}

}  // namespace

KeyframeGraph With(const Revision& closures, const KeyframeGraph& keys) {
  KeyframeGraph with = keys;
  with.closures.insert(with.closures.end(), closures.begin(), closures.end());
  return with;
}

KeyframeGraph Without(const Revision& cluster, const KeyframeGraph& keys) {
  KeyframeGraph without = keys;
  without.closures.clear();
  for (const RelativePoseConstraint& closure : keys.closures) {
    (IsIn(cluster, closure) ? without.refused : without.closures).push_back(closure);
  }
  for (const RelativePoseConstraint& closure : keys.contradicted) {
    if (!RepeatsOneOf(closure, without.refused, keys)) without.closures.push_back(closure);
  }
  without.contradicted.clear();
  return without;
}

std::vector<Revision> WithRepetitions(const std::vector<Revision>& clusters,
                                      const KeyframeGraph& keys) {
  std::vector<Revision> repeated;
  for (const Revision& cluster : clusters) {
    Revision with = cluster;
    for (const RelativePoseConstraint& closure : keys.closures) {
      if (!IsIn(cluster, closure) && RepeatsOneOf(closure, cluster, keys)) with.push_back(closure);
    }
    if (with.size() > cluster.size()) repeated.push_back(std::move(with));
  }
  return repeated;
}

std::vector<Revision> TentativeMatches(const KeyframeGraph& keys) {
  std::vector<Revision> matches;
  for (const RelativePoseConstraint& match : keys.tentative) matches.push_back({match});
  return matches;
}

WeighedHypothesis RecordOf(HypothesisKind kind, const Revision& revision,
                           const KeyframeGraph& keys) {
  WeighedHypothesis record;
  record.kind = kind;
  record.num_closures = static_cast<int>(revision.size());
  record.first_later_pose = record.first_earlier_pose = keys.keyframes.back().pose;
  for (const RelativePoseConstraint& closure : revision) {
    const int earlier = keys.keyframes[closure.from].pose, later = keys.keyframes[closure.to].pose;
    record.first_later_pose = std::min(record.first_later_pose, later);
    record.last_later_pose = std::max(record.last_later_pose, later);
    record.first_earlier_pose = std::min(record.first_earlier_pose, earlier);
    record.last_earlier_pose = std::max(record.last_earlier_pose, earlier);
  }
  return record;
}

void OptimizeEach(const Peers* peers, ThreadPool* pool, std::vector<KeyframeGraph>* graphs) {
  const std::vector<std::size_t> own = OwnShare(peers, graphs->size());
  pool->ForEachChunk(own.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    OptimizeKeyframes(&(*graphs)[own[i]]);
  });
  if (peers == nullptr) return;
  std::vector<char> is_own(graphs->size(), 0);
  for (const std::size_t i : own) is_own[i] = 1;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < graphs->size(); ++i) {
    for (const Pose2& key : (*graphs)[i].world_from_key) {
      const Pose2 pose = is_own[i] != 0 ? key : Pose2();
      numbers.insert(numbers.end(), {pose.x, pose.y, pose.yaw});
    }
  }
  SumOverPeers(peers, &numbers);
  const double* next = numbers.data();
  for (KeyframeGraph& graph : *graphs) {
    for (Pose2& key : graph.world_from_key) {
      key = Pose2(next);
      next += 3;
    }
  }
}

}  // namespace plumbline
