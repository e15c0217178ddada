#include "plumbline/solvers/loop_closure/moving_returns.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/share_graph.h"

namespace plumbline {
namespace {

// Scans on either side that may look through what moves. Tuned on simulated floors with people.
constexpr int kNeighbours = 6;
// Farther away, what is seen is another part of the building.
constexpr double kNeighbourReachM = 5.0;
// What is at rest is seen again from the next scan, if that is no farther away.
constexpr double kSeenAgainM = 1.0;
// Of the returns of a scan that is where it was taken, no larger share comes from people.
constexpr double kMostMoving = 0.4;

// What the neighbours of a scan on one side say of its returns.
struct Witnesses {
  std::vector<char> see, look_through;  // per return
  bool are_near = false;
};

class MovingReturns {
 public:
  MovingReturns(const SlamGraph& graph, const std::vector<int>& scans,
                const std::vector<Pose2>& world_from_robot,
                const std::vector<std::optional<FreeSpaceScan>>& free_space)
      : free_space_(free_space) {
    for (const int scan : scans) {
      world_from_robot_.push_back(world_from_robot[graph.all_scans()[scan].pose]);
    }
    for (const auto& scan : free_space) scans_.push_back(scan ? &*scan : nullptr);
    if (graph.peers() != nullptr) FetchNeighbours(graph, scans);
  }

  // Of one that the graph has.
  std::vector<int> Of(int scan) const {
    const Witnesses before = WitnessesOf(scan, -1), after = WitnessesOf(scan, 1);
    const bool are_near = before.are_near && after.are_near;
    std::vector<int> moving;
    const std::size_t num_returns = scans_[scan]->returns().size();
    for (std::size_t i = 0; i < num_returns; ++i) {
      const int num_sides = before.look_through[i] + after.look_through[i];
      const bool is_seen = before.see[i] != 0 || after.see[i] != 0;
      if (num_sides == 2 || (num_sides == 1 && are_near && !is_seen)) {
        moving.push_back(static_cast<int>(i));
      }
    }
    if (static_cast<double>(moving.size()) > kMostMoving * static_cast<double>(num_returns)) {
      moving.clear();
    }
    return moving;
  }

 private:
  int size() const { return static_cast<int>(scans_.size()); }

  void FetchNeighbours(const SlamGraph& graph, const std::vector<int>& scans) {
    std::vector<int> places, ids;
    for (int scan = 0; scan < size(); ++scan) {
      if (scans_[scan] != nullptr) continue;
      const auto first = free_space_.begin() + std::max(0, scan - kNeighbours);
      const auto end = free_space_.begin() + std::min(size(), scan + kNeighbours + 1);
      if (std::none_of(first, end, [](const auto& near) { return near.has_value(); })) continue;
      places.push_back(scan);
      ids.push_back(scans[scan]);
    }
    const SlamGraph fetched = FetchScans(graph, ids);
    fetched_.reserve(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      scans_[places[i]] = &fetched_.emplace_back(fetched, static_cast<int>(i));
    }
  }

  // side: -1 before, 1 after.
  Witnesses WitnessesOf(int scan, int side) const {
    const std::size_t num_returns = scans_[scan]->returns().size();
    Witnesses witnesses{std::vector<char>(num_returns), std::vector<char>(num_returns)};
    ComparedReturns compared;
    for (int i = 1; i <= kNeighbours; ++i) {
      const int viewer = scan + side * i;
      if (viewer < 0 || viewer >= size()) break;
      const Pose2 viewer_from_scan = Between(world_from_robot_[viewer], world_from_robot_[scan]);
      const double distance_m = viewer_from_scan.translation().norm();
      if (distance_m > kNeighbourReachM) break;
      if (distance_m < kSeenAgainM) witnesses.are_near = true;
      scans_[viewer]->Compare(*scans_[scan], viewer_from_scan, &compared);
      for (std::size_t k = 0; k < num_returns; ++k) {
        if (compared.verdicts[k] == ReturnVerdict::kAgrees) witnesses.see[k] = 1;
        if (compared.verdicts[k] == ReturnVerdict::kConflicts) witnesses.look_through[k] = 1;
      }
    }
    return witnesses;
  }

  const std::vector<std::optional<FreeSpaceScan>>& free_space_;
  std::vector<Pose2> world_from_robot_;      // of the scans
  std::vector<FreeSpaceScan> fetched_;       // of other processes
  std::vector<const FreeSpaceScan*> scans_;  // null: neighbour of none that the graph has
};

// own: per scan, filled by the process that has it.
void ShareOverPeers(const Peers& peers, std::vector<std::vector<int>>* own) {
  struct Return {
    int scan, place;
  };
  std::vector<Return> returns;
  for (std::size_t scan = 0; scan < own->size(); ++scan) {
    for (const int place : (*own)[scan]) returns.push_back({static_cast<int>(scan), place});
    (*own)[scan].clear();
  }
  for (const auto& [scan, place] : JoinOverPeers(&peers, std::move(returns))) {
    (*own)[scan].push_back(place);
  }
}

}  // namespace

std::vector<std::vector<int>> FindMovingReturns(
    const SlamGraph& graph, const std::vector<int>& scans,
    const std::vector<Pose2>& world_from_robot,
    const std::vector<std::optional<FreeSpaceScan>>& free_space, ThreadPool* pool) {
  const MovingReturns returns(graph, scans, world_from_robot, free_space);
  std::vector<std::vector<int>> moving(scans.size());
  constexpr std::size_t kScansPerChunk = 16;
  pool->ForEachChunk(scans.size(), kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t i = begin; i < end; ++i) {
                         if (free_space[i]) moving[i] = returns.Of(static_cast<int>(i));
                       }
                     });
  if (graph.peers() != nullptr) ShareOverPeers(*graph.peers(), &moving);
  return moving;
}

}  // namespace plumbline
