#include "plumbline/solvers/loop_closure/loop_candidates.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/point_index.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The search radii were tuned on fr079, intel and simulated buildings, the constants of suspect
// edges on the floors of the seeding study (apps/benchmark).

// Largest expected error of the relative pose of two keyframes after a way of w [m] between them,
// the shortest over sequential edges and closures found so far:
//   floor + drift_per_path * w + drift_per_path_squared * w^2, at most kMaxDriftM [m].
// The linear part is slip and scale, the quadratic one a heading that turns steadily.
constexpr double kDriftFloorM = 0.4;
constexpr double kDriftPerPath = 0.025;
constexpr double kDriftPerPathSquared1M = 1e-4;
constexpr double kMaxDriftM = 50.0;
// Largest expected error of their relative heading [rad], [rad/m].
constexpr double kDriftFloorRad = 0.15;
constexpr double kDriftRadPerM = 0.001;
// Additional error of an untrusted edge [m], [rad]. Less than half a turn: many rooms and corridors
// look alike from behind.
constexpr double kSuspectDriftM = 7.0;
constexpr double kSuspectDriftRad = 1.75;
// Additional cost of an untrusted edge [m]: any closure around it is the shorter way.
constexpr double kSuspectCostM = 300.0;
// Distance [m] within which two keyframes see enough of the same surfaces.
constexpr double kOverlapReachM = 2.0;
// Path from one candidate of revisits to the next [m].
constexpr double kSpacingM = 0.5;
// Earlier visits to a place that are tried, the nearest ones.
constexpr std::size_t kMaxVisits = 4;
// Drift [m] from which on a search is wide: it covers everything seen earlier within the drift,
// once per kWideSpacingM of path [m] or this share of the drift, whichever is more. One success
// brings its neighbours into reach.
constexpr double kWideDriftM = 1.0;
constexpr double kWideSpacingM = 3.0;
constexpr double kWideSpacingPerDrift = 0.25;
// Path [m] whose keyframes share one node when ways are measured: the error is a few centimetres of
// drift, and there are many times fewer nodes.
constexpr double kNodeM = 2.0;
// Bound on the distance [m] of a node's keyframes from its first one, bent as their path may be.
constexpr double kNodeRadiusM = 2.0 * kNodeM;
// Relocation of a segment, and of sessions: keyframes tried, and path between them [m], at least.
constexpr int kMaxJoins = 16;
constexpr int kMaxSessionJoins = 24;
constexpr double kMinJoinSpacingM = 4.0;
// Side [m] of the squares of the map in which sessions are looked for.
constexpr double kTileM = 40.0;

// A piece of way, or a whole one.
struct Way {
  double cost_m = kInfinity;
  int num_suspects = 0;

  double LengthM() const { return cost_m - kSuspectCostM * num_suspects; }
};

struct Link {
  int to = 0;
  Way way;
};

double DriftM(const Way& way) {
  const double length_m = way.LengthM();
  return std::min(kMaxDriftM, kDriftFloorM + kDriftPerPath * length_m +
                                  kDriftPerPathSquared1M * length_m * length_m +
                                  kSuspectDriftM * way.num_suspects);
}

double DriftRad(const Way& way) {
  if (way.num_suspects > 0) return kSuspectDriftRad;
  return std::min(kPi, kDriftFloorRad + kDriftRadPerM * way.LengthM());
}

// Cost of the path up to each keyframe [m].
std::vector<double> PathCost(const KeyframeGraph& graph) {
  std::vector<double> cost_m(graph.keyframes.size(), 0.0);
  for (std::size_t k = 1; k < cost_m.size(); ++k) {
    cost_m[k] = cost_m[k - 1] + graph.keyframes[k].path_m - graph.keyframes[k - 1].path_m +
                (graph.sequential[k - 1].untrusted() ? kSuspectCostM : 0.0);
  }
  return cost_m;
}

// Measures ways between nodes, stretches of path that are joined by the path driven and by
// closures.
class Ways {
 public:
  Ways(const KeyframeGraph& graph, const std::vector<double>& path_cost_m) {
    double begin_m = -kInfinity;
    for (std::size_t k = 0; k < path_cost_m.size(); ++k) {
      const bool begins_session = k > 0 && graph.sequential[k - 1].between_sessions;
      if (begins_session || path_cost_m[k] - begin_m >= kNodeM) {
        const double cost_m = path_cost_m[k] - begin_m;
        begin_m = path_cost_m[k];
        links_.emplace_back();
        first_key_.push_back(static_cast<int>(k));
        if (num_nodes() > 1 && !begins_session) {
          const int suspect_steps = k > 0 && graph.sequential[k - 1].untrusted() ? 1 : 0;
          Join(num_nodes() - 2, num_nodes() - 1, {cost_m, suspect_steps});
        }
      }
      node_of_key_.push_back(num_nodes() - 1);
    }
    first_key_.push_back(graph.size());
    // Nothing drifts within a finished map.
    for (int node = 1; node < num_nodes() && first_key_[node] < graph.num_fixed; ++node) {
      Join(0, node, Way{0.0, 0});
    }
    for (const RelativePoseConstraint& closure : graph.closures) {
      Join(node_of_key_[closure.from], node_of_key_[closure.to],
           {std::hypot(closure.from_from_to.x, closure.from_from_to.y), 0});
    }
  }

  int num_nodes() const { return static_cast<int>(links_.size()); }
  // The first keyframe of a node; for num_nodes() the number of keyframes.
  int FirstKeyOf(int node) const { return first_key_[node]; }

  // The cheapest ways from a node to all (Dijkstra 1959); only those to the targets are final.
  // targets: without repetitions.
  std::vector<Way> From(int source, const std::vector<int>& targets) const {
    std::vector<Way> ways(links_.size());
    std::vector<char> is_target(links_.size(), false);
    for (const int target : targets) is_target[target] = true;
    std::size_t num_left = targets.size();
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> open;
    ways[source].cost_m = 0.0;
    open.push({0.0, source});
    while (num_left > 0 && !open.empty()) {
      const auto [reached, node] = open.top();
      open.pop();
      if (reached > ways[node].cost_m) continue;
      if (std::exchange(is_target[node], false)) --num_left;
      for (const Link& link : links_[node]) {
        const double through = reached + link.way.cost_m;
        if (through >= ways[link.to].cost_m) continue;
        ways[link.to] = {through, ways[node].num_suspects + link.way.num_suspects};
        open.push({through, link.to});
      }
    }
    return ways;
  }

 private:
  void Join(int a, int b, const Way& way) {
    links_[a].push_back({b, way});
    links_[b].push_back({a, way});
  }

  std::vector<int> node_of_key_, first_key_;
  std::vector<std::vector<Link>> links_;
};

// One keyframe per square of 1 m and quarter of heading: the map of a wide search.
std::vector<int> Thinned(const std::vector<int>& keys, const KeyframeGraph& graph) {
  std::set<std::tuple<long, long, int>> taken;
  std::vector<int> thinned;
  for (const int key : keys) {
    const Pose2& pose = graph.world_from_key[key];
    const int quarter = static_cast<int>(std::floor(NormalizeAngle(pose.yaw) / (0.5 * kPi)));
    const auto [cell, is_new] = taken.emplace(std::lround(pose.x), std::lround(pose.y), quarter);
    if (is_new) thinned.push_back(key);
  }
  return thinned;
}

// Keyframes from `first` to `last`, at least this far from one another on the path.
std::vector<int> SpreadOverPath(const KeyframeGraph& graph, int first, int last, double spacing_m) {
  std::vector<int> keys;
  double next_m = graph.keyframes[first].path_m;
  for (int k = first; k <= last; ++k) {
    if (graph.keyframes[k].path_m < next_m) continue;
    next_m = graph.keyframes[k].path_m + spacing_m;
    keys.push_back(k);
  }
  return keys;
}

class CandidateFinder {
 public:
  explicit CandidateFinder(const KeyframeGraph& graph)
      : graph_(graph),
        path_cost_m_(PathCost(graph)),
        ways_(graph, path_cost_m_),
        nodes_(PositionsOfNodes(graph, ways_)),
        closed_with_(graph.keyframes.size()) {
    for (const auto* closures : {&graph.closures, &graph.contradicted}) {
      for (const RelativePoseConstraint& closure : *closures) {
        closed_with_[closure.to].push_back(closure.from);
      }
    }
  }

  int num_nodes() const { return ways_.num_nodes(); }

  // The candidates whose later keyframe lies in the node and is not before `first_key`.
  std::vector<LoopCandidate> OfNode(int node, int first_key) const {
    std::vector<LoopCandidate> candidates;
    if (ways_.FirstKeyOf(node + 1) <= first_key) return candidates;
    const std::vector<int> near = NodesNear(node);
    const std::vector<Way> ways = ways_.From(node, near);
    for (int second = std::max(first_key, ways_.FirstKeyOf(node));
         second < ways_.FirstKeyOf(node + 1); ++second) {
      if (BeginsStretch(second, kSpacingM)) AddCandidates(second, near, ways, &candidates);
    }
    return candidates;
  }

 private:
  struct Nearby {
    LoopCandidate candidate;
    double cost = kInfinity;
  };

  static PointIndex PositionsOfNodes(const KeyframeGraph& graph, const Ways& ways) {
    std::vector<double> positions;
    for (int node = 0; node < ways.num_nodes(); ++node) {
      const Pose2& pose = graph.world_from_key[ways.FirstKeyOf(node)];
      positions.insert(positions.end(), {pose.x, pose.y});
    }
    return PointIndex(std::move(positions));
  }

  Eigen::Vector2d PositionOf(int node) const {
    return graph_.world_from_key[ways_.FirstKeyOf(node)].translation();
  }

  // The node and those before it that may be in reach of its keyframes, in order.
  std::vector<int> NodesNear(int node) const {
    std::vector<PointIndex::Neighbor> neighbors;
    nodes_.FindWithin(PositionOf(node), kOverlapReachM + kMaxDriftM + 2.0 * kNodeRadiusM,
                      &neighbors);
    std::vector<int> nodes;
    for (const PointIndex::Neighbor& neighbor : neighbors) {
      if (static_cast<int>(neighbor.point) <= node) nodes.push_back(neighbor.point);
    }
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  }

  // Whether the keyframe is the first one of a stretch; the path is cut at multiples of stretch_m.
  bool BeginsStretch(int key, double stretch_m) const {
    if (key == 0) return true;
    const std::vector<Keyframe>& keys = graph_.keyframes;
    return std::floor(keys[key].path_m / stretch_m) != std::floor(keys[key - 1].path_m / stretch_m);
  }

  double PathBetween(int a, int b) const { return std::abs(path_cost_m_[a] - path_cost_m_[b]); }

  // Whether a closure, accepted or contradicted, ties the surroundings of the two.
  bool IsClosed(int first, int second) const {
    int to = second;
    while (to > 0 && PathBetween(to - 1, second) < kSpacingM) --to;
    for (; to < graph_.size() && PathBetween(to, second) < kSpacingM; ++to) {
      const std::vector<int>& froms = closed_with_[to];
      if (std::any_of(froms.begin(), froms.end(),
                      [&](int from) { return PathBetween(from, first) < kSpacingM; })) {
        return true;
      }
    }
    return false;
  }

  // Goes through the earlier keyframes of these nodes once; neighbours in time that are in reach
  // make up a visit.
  void AddCandidates(int second, const std::vector<int>& nodes, const std::vector<Way>& ways,
                     std::vector<LoopCandidate>* candidates) const {
    const Pose2& place = graph_.world_from_key[second];
    std::vector<Nearby> visits;
    Nearby wide;
    std::vector<int> wide_keys;
    int last_of_visit = -1;
    for (const int node : nodes) {
      if (!std::isfinite(ways[node].cost_m)) continue;  // sessions that nothing ties
      Nearby near;
      near.candidate.second = second;
      near.candidate.drift_m = DriftM(ways[node]);
      near.candidate.drift_rad = DriftRad(ways[node]);
      const double reach_m = kOverlapReachM + near.candidate.drift_m;
      if ((place.translation() - PositionOf(node)).norm() > kNodeRadiusM + reach_m) continue;
      for (int first = ways_.FirstKeyOf(node); first < ways_.FirstKeyOf(node + 1); ++first) {
        if (first >= second || PathBetween(first, second) < LoopAcceptance::kRevisitPathM) break;
        const Pose2& earlier = graph_.world_from_key[first];
        const double distance_m = (earlier.translation() - place.translation()).norm();
        if (distance_m > reach_m) continue;
        near.candidate.first = first;
        near.cost = ViewDistanceM(distance_m, place.yaw - earlier.yaw);
        if (near.candidate.drift_m > kWideDriftM) {
          wide_keys.push_back(first);
          if (near.cost < wide.cost) wide = near;
        } else {
          if (visits.empty() || first != last_of_visit + 1) visits.emplace_back();
          if (near.cost < visits.back().cost) visits.back() = near;
          last_of_visit = first;
        }
      }
    }
    std::stable_sort(visits.begin(), visits.end(),
                     [](const Nearby& a, const Nearby& b) { return a.cost < b.cost; });
    if (visits.size() > kMaxVisits) visits.resize(kMaxVisits);
    for (const Nearby& visit : visits) {
      if (!IsClosed(visit.candidate.first, second)) candidates->push_back(visit.candidate);
    }
    const double wide_spacing_m =
        std::max(kWideSpacingM, kWideSpacingPerDrift * wide.candidate.drift_m);
    if (!wide_keys.empty() && BeginsStretch(second, wide_spacing_m)) {
      wide.candidate.surroundings = Thinned(wide_keys, graph_);
      candidates->push_back(wide.candidate);
    }
  }

  const KeyframeGraph& graph_;
  std::vector<double> path_cost_m_;
  Ways ways_;
  PointIndex nodes_;                           // first keyframe of each
  std::vector<std::vector<int>> closed_with_;  // per later keyframe of a closure the earlier ones
};

// A LoopCandidate without its surroundings.
struct PlainCandidate {
  std::size_t node, num_surroundings;
  int first, second;
  double drift_m, drift_rad;
};

// Gives all processes the candidates of each node, which one of them has found.
void ShareCandidates(const Peers* peers, std::vector<std::vector<LoopCandidate>>* of_node) {
  if (peers == nullptr) return;
  std::vector<PlainCandidate> candidates;
  std::vector<int> surroundings;
  for (std::size_t node = 0; node < of_node->size(); ++node) {
    for (const LoopCandidate& candidate : (*of_node)[node]) {
      candidates.push_back({node, candidate.surroundings.size(), candidate.first, candidate.second,
                            candidate.drift_m, candidate.drift_rad});
      surroundings.insert(surroundings.end(), candidate.surroundings.begin(),
                          candidate.surroundings.end());
    }
    (*of_node)[node].clear();
  }
  surroundings = JoinOverPeers(peers, std::move(surroundings));
  auto next = surroundings.begin();
  for (const PlainCandidate& plain : JoinOverPeers(peers, std::move(candidates))) {
    const auto end = next + static_cast<std::ptrdiff_t>(plain.num_surroundings);
    (*of_node)[plain.node].push_back(
        {plain.first, plain.second, plain.drift_m, plain.drift_rad, {next, end}});
    next = end;
  }
}

}  // namespace

double ViewDistanceM(double distance_m, double turn_rad) {
  constexpr double kMetresPerRad = 1.0;
  return distance_m + kMetresPerRad * std::abs(NormalizeAngle(turn_rad));
}

std::vector<LoopCandidate> FindLoopCandidates(const KeyframeGraph& graph, const Peers* peers,
                                              ThreadPool* pool, int first_key) {
  const CandidateFinder finder(graph);
  std::vector<std::vector<LoopCandidate>> of_node(finder.num_nodes());
  const std::vector<std::size_t> own = OwnShare(peers, of_node.size());
  pool->ForEach(own.size(), 1, [&](std::size_t i) {
    of_node[own[i]] = finder.OfNode(static_cast<int>(own[i]), first_key);
  });
  ShareCandidates(peers, &of_node);
  std::vector<LoopCandidate> candidates;
  for (std::vector<LoopCandidate>& of_this : of_node) {
    candidates.insert(candidates.end(), std::make_move_iterator(of_this.begin()),
                      std::make_move_iterator(of_this.end()));
  }
  return candidates;
}

std::vector<LoopCandidate> FindJoins(const KeyframeGraph& graph, int edge) {
  const std::vector<Keyframe>& keys = graph.keyframes;
  std::vector<int> before(edge + 1);
  std::iota(before.begin(), before.end(), 0);
  const std::vector<int> surroundings = Thinned(before, graph);
  int last = edge + 1;
  while (last + 1 < graph.size() && !graph.sequential[last].untrusted()) ++last;
  const double path_m = keys[last].path_m - keys[edge + 1].path_m;
  std::vector<LoopCandidate> joins;
  for (const int k :
       SpreadOverPath(graph, edge + 1, last, std::max(kMinJoinSpacingM, path_m / kMaxJoins))) {
    const Way way{keys[k].path_m - keys[edge].path_m + kSuspectCostM, 1};
    // Turned about the edge, it may lie on the other side of it.
    const double away_m =
        Between(graph.world_from_key[edge], graph.world_from_key[k]).translation().norm();
    joins.push_back({edge, k, DriftM(way) + 2.0 * away_m, kPi, surroundings});
  }
  return joins;
}

std::vector<LoopCandidate> FindSessionJoins(const KeyframeGraph& graph, int first_of_second) {
  std::map<std::pair<long, long>, std::vector<int>> tiles;
  for (int k = 0; k < first_of_second; ++k) {
    const Eigen::Vector2d at = graph.world_from_key[k].translation() / kTileM;
    tiles[{std::lround(at.x()), std::lround(at.y())}].push_back(k);
  }
  const int last = graph.size() - 1;
  const double path_m = graph.keyframes[last].path_m - graph.keyframes[first_of_second].path_m;
  const std::vector<int> wanted = SpreadOverPath(
      graph, first_of_second, last, std::max(kMinJoinSpacingM, path_m / kMaxSessionJoins));
  std::vector<LoopCandidate> joins;
  for (const auto& [cell, keys] : tiles) {
    LoopCandidate join;
    join.unknown = true;
    join.drift_rad = kPi;
    join.surroundings = Thinned(keys, graph);
    const Eigen::Vector2d middle(kTileM * static_cast<double>(cell.first),
                                 kTileM * static_cast<double>(cell.second));
    const auto from_middle_m = [&](int k) {
      return (graph.world_from_key[k].translation() - middle).norm();
    };
    join.first =
        *std::min_element(join.surroundings.begin(), join.surroundings.end(),
                          [&](int a, int b) { return from_middle_m(a) < from_middle_m(b); });
    for (const int k : keys) {
      const Pose2 apart = Between(graph.world_from_key[join.first], graph.world_from_key[k]);
      join.drift_m =
          std::max(join.drift_m, apart.translation().cwiseAbs().maxCoeff() + kOverlapReachM);
    }
    for (const int k : wanted) {
      join.second = k;
      joins.push_back(join);
    }
  }
  return joins;
}

}  // namespace plumbline
