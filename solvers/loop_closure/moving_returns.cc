#include "plumbline/solvers/loop_closure/moving_returns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/joined_returns.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/sort_unique.h"
#include "plumbline/solvers/front_end/free_space.h"

namespace plumbline {
namespace {

// Witnesses of a scan on either side. Tuned on simulated floors with people.
constexpr int kNumWitnesses = 6;
// Distance of the witnesses of a drive along its path.
constexpr double kWitnessSpacingM = 0.1, kWitnessSpacingRad = DegToRad(10.0);
// Farther away, a witness sees another part of the building.
constexpr double kWitnessReachM = 5.0;
// A surface at rest is seen again from the next witness within this distance.
constexpr double kSeenAgainM = 1.0;
// Largest share of moving returns of a scan whose pose is right.
constexpr double kMaxMovingShare = 0.4;

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
    if (distance_m > kWitnessReachM) break;
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
  if (static_cast<double>(moving.size()) > kMaxMovingShare * static_cast<double>(num_returns)) {
    moving.clear();
  }
  return moving;
}

// The witnesses of a scan on one side, the nearest one first. side: -1 before, 1 after.
std::vector<int> WitnessesOf(int scan, const std::vector<int>& witnesses, int side) {
  const auto at = side < 0 ? std::lower_bound(witnesses.begin(), witnesses.end(), scan)
                           : std::upper_bound(witnesses.begin(), witnesses.end(), scan);
  const auto num = std::min<std::ptrdiff_t>(
      kNumWitnesses, side < 0 ? at - witnesses.begin() : witnesses.end() - at);
  if (side > 0) return {at, at + num};
  return {std::make_reverse_iterator(at), std::make_reverse_iterator(at - num)};
}

// Gives all processes the places of each scan, which one of them has found.
void ShareOverPeers(const Peers* peers, std::vector<std::vector<int>>* of_scan) {
  if (peers == nullptr) return;
  std::vector<std::pair<int, int>> places;
  for (std::size_t scan = 0; scan < of_scan->size(); ++scan) {
    for (const int place : (*of_scan)[scan]) places.emplace_back(static_cast<int>(scan), place);
    (*of_scan)[scan].clear();
  }
  for (const auto& [scan, place] : JoinOverPeers(peers, std::move(places))) {
    (*of_scan)[scan].push_back(place);
  }
}

// Ids among all returns of those at the given places of a scan and between them, in objects of a
// person's or a cart's size: a wall that is looked through is the sign of a jump of the poses.
std::vector<std::size_t> ReturnsOfPeople(const SlamGraph& graph, int scan,
                                         const std::vector<int>& places) {
  constexpr double kMinGapM = 0.15, kMaxSizeM = 1.5;  // between objects; of an object
  const ScanEntry& entry = graph.scan(scan);
  const std::size_t first_return = graph.all_scans()[graph.IdAmongAll(scan)].first_return;
  const std::size_t stride = FreeSpaceScan::StrideOf(graph.LaserOfScan(scan));
  std::vector<Eigen::Vector2d> points;
  std::vector<bool> joined;
  MeasuredPoints(graph, scan, &points);
  FindJoinedReturns(graph, scan, points, kMinGapM, &joined);
  std::vector<std::size_t> ids;
  std::size_t begin = 0, end = 0, next = 0;  // of the object; the first return not looked at yet
  for (const int place : places) {
    const std::size_t at = place * stride;
    for (; end <= at; ++end) {
      if (!joined[end]) begin = end;
    }
    while (end < entry.num_returns && joined[end]) ++end;
    Eigen::AlignedBox2d box;
    for (std::size_t i = begin; i < end; ++i) box.extend(points[i]);
    if (box.diagonal().norm() > kMaxSizeM) continue;
    const std::size_t first = std::max({begin, next, at - std::min(at, stride - 1)});
    next = std::min(end, at + stride);
    for (std::size_t i = first; i < next; ++i) ids.push_back(first_return + i);
  }
  return ids;
}

}  // namespace

std::vector<int> ScansAlongPath(const SlamGraph& graph, const std::vector<Pose2>& world_from_robot,
                                double spacing_m, double spacing_rad) {
  const std::vector<ScanEntry>& all = graph.all_scans();
  std::vector<int> scans;
  for (int scan = 0; scan < static_cast<int>(all.size()); ++scan) {
    if (all[scan].num_returns == 0) continue;
    if (!scans.empty()) {
      const Pose2 step =
          Between(world_from_robot[all[scans.back()].pose], world_from_robot[all[scan].pose]);
      if (step.translation().norm() < spacing_m && std::abs(step.yaw) < spacing_rad) continue;
    }
    scans.push_back(scan);
  }
  return scans;
}

std::vector<std::vector<int>> FindMovingReturns(const ScanSurfaces& surfaces,
                                                const std::vector<int>& scans,
                                                const std::vector<int>& witnesses,
                                                const std::vector<Pose2>& world_from_robot,
                                                ThreadPool* pool) {
  const SlamGraph& graph = surfaces.graph();
  std::vector<std::size_t> own;
  std::vector<int> needed;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (OwnScan(graph, scans[i]) < 0) continue;
    own.push_back(i);
    for (const int side : {-1, 1}) {
      const std::vector<int> of_scan = WitnessesOf(scans[i], witnesses, side);
      needed.insert(needed.end(), of_scan.begin(), of_scan.end());
    }
  }
  const ScanSurfaces known = surfaces.With(needed);
  std::vector<std::vector<int>> moving(scans.size());
  constexpr std::size_t kScansPerChunk = 64;
  pool->ForEachChunk(
      own.size(), kScansPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        std::map<int, FreeSpaceScan> free_space;  // of the scans of the chunk and their witnesses
        const auto place = [&](int scan) -> ViewingScan {
          auto found = free_space.find(scan);
          if (found == free_space.end()) {
            found = free_space.emplace(scan, known.FreeSpaceOf(scan)).first;
          }
          return {&found->second, world_from_robot[graph.all_scans()[scan].pose]};
        };
        const auto placed_witnesses = [&](int scan, int side) {
          std::vector<ViewingScan> placed;
          for (const int witness : WitnessesOf(scan, witnesses, side)) {
            placed.push_back(place(witness));
          }
          return placed;
        };
        for (std::size_t i = begin; i < end; ++i) {
          const int scan = scans[own[i]];
          moving[own[i]] =
              MovingReturnsOf(place(scan), placed_witnesses(scan, -1), placed_witnesses(scan, 1));
        }
      });
  ShareOverPeers(graph.peers(), &moving);
  return moving;
}

std::vector<std::size_t> FindMovingReturnsOfDrive(const ScanSurfaces& surfaces,
                                                  const std::vector<Pose2>& world_from_robot,
                                                  ThreadPool* pool) {
  const SlamGraph& graph = surfaces.graph();
  const std::vector<ScanEntry>& all = graph.all_scans();
  const std::vector<int> witnesses =
      ScansAlongPath(graph, world_from_robot, kWitnessSpacingM, kWitnessSpacingRad);
  const auto find = [&](const std::vector<int>& scans) {
    const std::vector<std::vector<int>> places =
        FindMovingReturns(surfaces, scans, witnesses, world_from_robot, pool);
    std::vector<std::size_t> moving;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const int own_scan = OwnScan(graph, scans[i]);
      if (own_scan < 0 || places[i].empty()) continue;
      const std::vector<std::size_t> of_scan = ReturnsOfPeople(graph, own_scan, places[i]);
      moving.insert(moving.end(), of_scan.begin(), of_scan.end());
    }
    moving = JoinOverPeers(graph.peers(), std::move(moving));
    SortUnique(&moving);
    return moving;
  };
  const auto every = [&](std::size_t stride) {
    std::vector<int> scans;
    for (std::size_t scan = 0; scan < all.size(); scan += stride) {
      scans.push_back(static_cast<int>(scan));
    }
    return scans;
  };
  constexpr std::size_t kSampleSize = 200;
  // Odd, so that the sample alternates between two lasers.
  const std::vector<int> sample = every((all.size() / kSampleSize) | 1);
  double num_returns = 0.0;
  for (const int scan : sample) num_returns += static_cast<double>(all[scan].num_returns);
  if (static_cast<double>(find(sample).size()) <= kFewMoving * num_returns) return {};
  return find(every(1));
}

}  // namespace plumbline
