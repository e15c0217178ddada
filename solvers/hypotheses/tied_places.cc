#include "plumbline/solvers/hypotheses/tied_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/pose_graph/uncertain_edges.h"

namespace plumbline {
namespace {

// A wrong tie bends what lies this near to its place [m]. What is bent over a longer way was bent
// before: its own loops were open, and the ties close them.
constexpr double kBentReachM = 2.0 * LoopAcceptance::kClusterPlaceM;

struct Place {
  Eigen::Vector2d middle;      // the keyframe of its first closure
  std::vector<char> is_tying;  // per closure of the graph
};

class TiedPlaces {
 public:
  TiedPlaces(const KeyframeGraph& keys, int first, int end) : keys_(keys) {
    std::vector<std::pair<int, std::size_t>> ties;  // the keyframe of the part, the closure
    for (std::size_t i = 0; i < keys.closures.size(); ++i) {
      const int from = keys.closures[i].from, to = keys.closures[i].to;
      const bool has_from = from >= first && from < end, has_to = to >= first && to < end;
      if (has_from != has_to) ties.emplace_back(has_from ? from : to, i);
    }
    std::sort(ties.begin(), ties.end());
    for (const auto& [key, tie] : ties) PlaceAt(PositionOf(key)).is_tying[tie] = 1;
  }

  std::size_t size() const { return places_.size(); }

  TiedPlace Test(std::size_t index, double least_relief) const {
    const Place& place = places_[index];
    TiedPlace tested;
    KeyframeGraph without = keys_;
    without.closures.clear();
    for (std::size_t i = 0; i < keys_.closures.size(); ++i) {
      (place.is_tying[i] != 0 ? tested.closures : without.closures).push_back(keys_.closures[i]);
    }
    const double bent = Chi2Around(place, keys_.world_from_key);
    // No more than all of it can go.
    if (bent <= least_relief) return tested;
    OptimizeKeyframes(&without);
    tested.relief = bent - Chi2Around(place, without.world_from_key);
    return tested;
  }

 private:
  Eigen::Vector2d PositionOf(int key) const { return keys_.world_from_key[key].translation(); }

  Place& PlaceAt(const Eigen::Vector2d& position) {
    const auto found = std::find_if(places_.begin(), places_.end(), [&](const Place& place) {
      return (place.middle - position).norm() < LoopAcceptance::kClusterPlaceM;
    });
    if (found != places_.end()) return *found;
    places_.push_back({position, std::vector<char>(keys_.closures.size(), 0)});
    return places_.back();
  }

  // Of all edges there but the closures in question, by these poses. As the optimisation weighs it.
  double Chi2Around(const Place& place, const std::vector<Pose2>& poses) const {
    constexpr double kScaleSquared = kCauchyScale * kCauchyScale;
    const auto is_near = [&](const RelativePoseConstraint& edge) {
      return (PositionOf(edge.from) - place.middle).norm() < kBentReachM &&
             (PositionOf(edge.to) - place.middle).norm() < kBentReachM;
    };
    double chi2 = 0.0;
    for (const SequentialEdge& edge : keys_.sequential) {
      if (!edge.broken && is_near(edge.constraint)) chi2 += EdgeChi2(edge.constraint, poses);
    }
    for (std::size_t i = 0; i < keys_.closures.size(); ++i) {
      if (place.is_tying[i] != 0 || !is_near(keys_.closures[i])) continue;
      chi2 += kScaleSquared * std::log1p(EdgeChi2(keys_.closures[i], poses) / kScaleSquared);
    }
    return chi2;
  }

  const KeyframeGraph& keys_;
  std::vector<Place> places_;
};

}  // namespace

std::vector<TiedPlace> TestTiedPlaces(const KeyframeGraph& keys, int first, int end,
                                      double least_relief, ThreadPool* pool) {
  const TiedPlaces places(keys, first, end);
  std::vector<TiedPlace> tested(places.size());
  pool->ForEachChunk(places.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    tested[i] = places.Test(i, least_relief);
  });
  return tested;
}

std::vector<TiedPlace> BentPlaces(const KeyframeGraph& keys, ThreadPool* pool) {
  std::vector<TiedPlace> bent;
  for (int first = 0; first < keys.size(); first = keys.EndOfSession(first)) {
    for (TiedPlace& place :
         TestTiedPlaces(keys, first, keys.EndOfSession(first), LoopAcceptance::kMaxRelief, pool)) {
      if (place.is_bent()) bent.push_back(std::move(place));
    }
  }
  return bent;
}

}  // namespace plumbline
