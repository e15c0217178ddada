#include "plumbline/solvers/loop_closure/moving_returns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/joined_returns.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/sort_unique.h"
#include "plumbline/solvers/loop_closure/scans_along_path.h"

namespace plumbline {
namespace {

// Scans on either side that may look through what moves. Tuned on simulated floors with people.
constexpr int kNeighbours = 6;
// Of a drive, one scan per so much of its path may look through what moves.
constexpr double kWitnessSpacingM = 0.1, kWitnessSpacingRad = DegToRad(10.0);
// Farther away, what is seen is another part of the building.
constexpr double kNeighbourReachM = 5.0;
// What is at rest is seen again from the next scan, if that is no farther away.
constexpr double kSeenAgainM = 1.0;
// Of the returns of a scan that is where it was taken, no larger share comes from people.
constexpr double kMostMoving = 0.4;

// A scan, and where it was taken from.
struct ViewingScan {
  const FreeSpaceScan* scan;
  Pose2 world_from_robot;
};

// What the witnesses of a scan on one side say of its returns.
struct Testimony {
  std::vector<char> see, look_through;  // per return
  bool are_near = false;
};

// witnesses: the nearest one first.
Testimony Hear(const std::vector<ViewingScan>& witnesses, const ViewingScan& of) {
  const std::size_t num_returns = of.scan->returns().size();
  Testimony testimony{std::vector<char>(num_returns), std::vector<char>(num_returns)};
  ComparedReturns compared;
  for (const ViewingScan& witness : witnesses) {
    const Pose2 witness_from_scan = Between(witness.world_from_robot, of.world_from_robot);
    const double distance_m = witness_from_scan.translation().norm();
    if (distance_m > kNeighbourReachM) break;
    if (distance_m < kSeenAgainM) testimony.are_near = true;
    witness.scan->Compare(*of.scan, witness_from_scan, &compared);
    for (std::size_t k = 0; k < num_returns; ++k) {
      if (compared.verdicts[k] == ReturnVerdict::kAgrees) testimony.see[k] = 1;
      if (compared.verdicts[k] == ReturnVerdict::kConflicts) testimony.look_through[k] = 1;
    }
  }
  return testimony;
}

// Places among the returns() of a scan.
std::vector<int> MovingReturnsOf(const ViewingScan& scan, const std::vector<ViewingScan>& before,
                                 const std::vector<ViewingScan>& after) {
  const Testimony earlier = Hear(before, scan), later = Hear(after, scan);
  const bool are_near = earlier.are_near && later.are_near;
  std::vector<int> moving;
  const std::size_t num_returns = scan.scan->returns().size();
  for (std::size_t i = 0; i < num_returns; ++i) {
    const int num_sides = earlier.look_through[i] + later.look_through[i];
    const bool is_seen = earlier.see[i] != 0 || later.see[i] != 0;
    if (num_sides == 2 || (num_sides == 1 && are_near && !is_seen)) {
      moving.push_back(static_cast<int>(i));
    }
  }
  if (static_cast<double>(moving.size()) > kMostMoving * static_cast<double>(num_returns)) {
    moving.clear();
  }
  return moving;
}

// Of the scans of a list, each by the ones before and after it there.
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
    return MovingReturnsOf(PlacedScan(scan), Neighbours(scan, -1), Neighbours(scan, 1));
  }

 private:
  int size() const { return static_cast<int>(scans_.size()); }
  ViewingScan PlacedScan(int scan) const { return {scans_[scan], world_from_robot_[scan]}; }

  // side: -1 before, 1 after.
  std::vector<ViewingScan> Neighbours(int scan, int side) const {
    std::vector<ViewingScan> neighbours;
    for (int i = 1; i <= kNeighbours; ++i) {
      const int neighbour = scan + side * i;
      if (neighbour < 0 || neighbour >= size()) break;
      neighbours.push_back(PlacedScan(neighbour));
    }
    return neighbours;
  }

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

// Diagonal of the box around some points; at least one.
double Extent(const Eigen::Vector2d* begin, const Eigen::Vector2d* end) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d* point = begin; point != end; ++point) box.extend(*point);
  return box.diagonal().norm();
}

// Finds what moves in any scan of a drive, by witnesses along its path.
class MovingReturnsOfDrive {
 public:
  MovingReturnsOfDrive(const ScanSurfaces& surfaces, const std::vector<Pose2>& world_from_robot)
      : graph_(surfaces.graph()),
        poses_(world_from_robot),
        witnesses_(ScansAlongPath(graph_, poses_, kWitnessSpacingM, kWitnessSpacingRad)),
        surfaces_(surfaces) {
    if (graph_.peers() != nullptr) FetchWitnesses();
  }

  // Every so many scans of all, those of them that the graph has.
  std::vector<int> Sample() const {
    constexpr std::size_t kSampleSize = 200;
    // Odd, so as to take the scans of two lasers in turn.
    const std::size_t stride = (graph_.all_scans().size() / kSampleSize) | 1;
    std::vector<int> sample;
    for (int scan = 0; scan < graph_.num_scans(); ++scan) {
      if (graph_.IdAmongAll(scan) % stride == 0) sample.push_back(scan);
    }
    return sample;
  }

  // Per own scan of a list: ids among all returns.
  std::vector<std::vector<std::size_t>> Find(const std::vector<int>& scans,
                                             ThreadPool* pool) const {
    std::vector<std::vector<std::size_t>> moving(scans.size());
    constexpr std::size_t kScansPerChunk = 64;
    pool->ForEachChunk(scans.size(), kScansPerChunk,
                       [&](std::size_t, std::size_t begin, std::size_t end) {
                         std::map<int, FreeSpaceScan> witnesses;  // that the chunk has met
                         for (std::size_t i = begin; i < end; ++i) {
                           moving[i] = FindIn(scans[i], &witnesses);
                         }
                       });
    return moving;
  }

 private:
  const Pose2& PoseOf(int scan) const { return poses_[graph_.all_scans()[scan].pose]; }

  void FetchWitnesses() {
    std::vector<int> needed;
    for (int scan = 0; scan < graph_.num_scans(); ++scan) {
      for (const int side : {-1, 1}) {
        const std::vector<int> witnesses = WitnessesOf(graph_.IdAmongAll(scan), side);
        needed.insert(needed.end(), witnesses.begin(), witnesses.end());
      }
    }
    SortUnique(&needed);
    surfaces_ = surfaces_.With(needed);
  }

  // By ids among all, the nearest one first. side: -1 before, 1 after.
  std::vector<int> WitnessesOf(int scan, int side) const {
    const auto at = side < 0 ? std::lower_bound(witnesses_.begin(), witnesses_.end(), scan)
                             : std::upper_bound(witnesses_.begin(), witnesses_.end(), scan);
    const auto num = std::min<std::ptrdiff_t>(
        kNeighbours, side < 0 ? at - witnesses_.begin() : witnesses_.end() - at);
    if (side > 0) return {at, at + num};
    return {std::make_reverse_iterator(at), std::make_reverse_iterator(at - num)};
  }

  std::vector<ViewingScan> PlacedWitnesses(int scan, int side,
                                           std::map<int, FreeSpaceScan>* known) const {
    std::vector<ViewingScan> placed;
    for (const int witness : WitnessesOf(scan, side)) {
      auto found = known->find(witness);
      if (found == known->end()) {
        found = known->emplace(witness, surfaces_.FreeSpaceOf(witness)).first;
      }
      placed.push_back({&found->second, PoseOf(witness)});
    }
    return placed;
  }

  std::vector<std::size_t> FindIn(int own_scan, std::map<int, FreeSpaceScan>* witnesses) const {
    if (graph_.scan(own_scan).num_returns == 0) return {};
    const int scan = graph_.IdAmongAll(own_scan);
    const FreeSpaceScan free_space(graph_, own_scan);
    const std::vector<int> places =
        MovingReturnsOf({&free_space, PoseOf(scan)}, PlacedWitnesses(scan, -1, witnesses),
                        PlacedWitnesses(scan, 1, witnesses));
    return places.empty() ? std::vector<std::size_t>() : ReturnsOfPeople(own_scan, places);
  }

  // The returns that move and those between them, of objects of a person's or a cart's size. A wall
  // that is looked through tells of a jump of the poses.
  std::vector<std::size_t> ReturnsOfPeople(int scan, const std::vector<int>& places) const {
    constexpr double kGapM = 0.15, kLargestM = 1.5;  // between objects; of one
    const ScanEntry& entry = graph_.scan(scan);
    const std::size_t first_return = graph_.all_scans()[graph_.IdAmongAll(scan)].first_return;
    const std::size_t stride = FreeSpaceScan::StrideOf(graph_.LaserOfScan(scan));
    std::vector<Eigen::Vector2d> points;
    std::vector<bool> joined;
    MeasuredPoints(graph_, scan, &points);
    FindJoinedReturns(graph_, scan, points, kGapM, &joined);
    std::vector<std::size_t> ids;
    std::size_t begin = 0, end = 0, next = 0;  // of the object; the first return not looked at yet
    for (const int place : places) {
      const std::size_t at = place * stride;
      for (; end <= at; ++end) {
        if (!joined[end]) begin = end;
      }
      while (end < entry.num_returns && joined[end]) ++end;
      if (Extent(points.data() + begin, points.data() + end) > kLargestM) continue;
      const std::size_t first = std::max({begin, next, at - std::min(at, stride - 1)});
      next = std::min(end, at + stride);
      for (std::size_t i = first; i < next; ++i) ids.push_back(first_return + i);
    }
    return ids;
  }

  const SlamGraph& graph_;
  const std::vector<Pose2>& poses_;
  const std::vector<int> witnesses_;  // by ids among all, in order
  ScanSurfaces surfaces_;             // knows the witnesses of the graph's scans
};

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

std::vector<std::size_t> FindMovingReturnsOfDrive(const ScanSurfaces& surfaces,
                                                  const std::vector<Pose2>& world_from_robot,
                                                  ThreadPool* pool) {
  const SlamGraph& graph = surfaces.graph();
  const MovingReturnsOfDrive drive(surfaces, world_from_robot);
  const std::vector<int> sample = drive.Sample();
  std::vector<double> counts(2);  // of the sample's returns: those that move, all
  for (const std::vector<std::size_t>& returns : drive.Find(sample, pool)) {
    counts[0] += static_cast<double>(returns.size());
  }
  for (const int scan : sample) counts[1] += static_cast<double>(graph.scan(scan).num_returns);
  SumOverPeers(graph.peers(), &counts);
  if (counts[0] <= kFewMoving * counts[1]) return {};

  std::vector<int> all(graph.num_scans());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::size_t> moving;
  for (const std::vector<std::size_t>& returns : drive.Find(all, pool)) {
    moving.insert(moving.end(), returns.begin(), returns.end());
  }
  if (graph.peers() != nullptr) {
    moving = JoinOverPeers(graph.peers(), std::move(moving));
    SortUnique(&moving);
  }
  return moving;
}

}  // namespace plumbline
