#include "plumbline/solvers/loop_closure/consistency_meter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/median.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/sort_unique.h"
#include "plumbline/solvers/loop_closure/moving_returns.h"

namespace plumbline {
namespace {

// Distance of neighbouring viewpoints.
constexpr double kViewpointSpacingM = 0.5, kViewpointSpacingRad = 0.5;

// Path between two scans of one pass [m]: they differ by moving returns and noise, hardly by drift.
constexpr double kMinWithinM = 1.0, kMaxWithinM = 5.0;
constexpr std::size_t kPartnersWithin = 4;
// Shortest path between two passes [m]: the robot has left the room or turned round since.
constexpr double kMinBetweenM = 8.0;
// Largest distance of two scans of different passes [m], in cells of 1 m: they see the same
// surfaces.
constexpr int kPartnerReachM = 4;
constexpr std::size_t kPartnersBetween = 8;

// Length of the stretches whose conflicts are compared [m]. A wrong closure bends only a part of
// the map.
constexpr double kStretchM = 6.0;
// Fewer conflicting returns of a pair of scans are noise.
constexpr int kMinConflictingReturns = 10;

struct Viewpoint {
  int pose;
  int scan;
  double path_m;  // straight from viewpoint to viewpoint: noise of a robot at rest adds nothing
  Pose2 world_from_robot;
};

std::vector<Viewpoint> PlaceViewpoints(const SlamGraph& graph, const std::vector<int>& scans,
                                       const std::vector<Pose2>& poses) {
  std::vector<Viewpoint> viewpoints;
  viewpoints.reserve(scans.size());
  for (const int scan : scans) {
    const int pose = graph.all_scans()[scan].pose;
    double path_m = 0.0;
    if (!viewpoints.empty()) {
      const Viewpoint& before = viewpoints.back();
      path_m = before.path_m + Between(before.world_from_robot, poses[pose]).translation().norm();
    }
    viewpoints.push_back({pose, scan, path_m, poses[pose]});
  }
  return viewpoints;
}

// Two viewpoints, `first` before `second`, both ways.
struct ViewpointPair {
  int first, second;
  bool between_passes;
  FreeSpaceConflict first_views = {}, second_views = {};
  FreeSpaceConflict with_moving = {};  // both ways, moving returns included
  // A conflicting return each, in the frame of the viewer's robot.
  Eigen::Vector2d seen_by_first = Eigen::Vector2d::Zero();
  Eigen::Vector2d seen_by_second = Eigen::Vector2d::Zero();

  FreeSpaceConflict AtRest() const {
    FreeSpaceConflict conflict = first_views;
    return conflict += second_views;
  }
};

// Number of the entries, which are in order of the path, before `path_m`.
template <typename Entries, typename PathOf>
std::size_t CountBefore(const Entries& entries, double path_m, PathOf path_of) {
  return std::partition_point(entries.begin(), entries.end(),
                              [&](const auto& entry) { return path_of(entry) < path_m; }) -
         entries.begin();
}

// Viewpoints by square cells of 1 m, each in order of the path.
class ViewpointGrid {
 public:
  explicit ViewpointGrid(const std::vector<Viewpoint>& viewpoints) : viewpoints_(viewpoints) {}

  void Add(int viewpoint) { cells_[CellOf(viewpoint)].push_back(viewpoint); }

  // At most kPartnersBetween of the viewpoints around `viewpoint` that were added and belong to
  // earlier passes, evenly spread over places and passes.
  std::vector<int> Partners(int viewpoint) const {
    const Eigen::Vector2d position = viewpoints_[viewpoint].world_from_robot.translation();
    const auto [y, x] = CellOf(viewpoint);
    std::vector<std::pair<const std::vector<int>*, std::size_t>> earlier;
    std::size_t total = 0;
    for (long row = y - kPartnerReachM; row <= y + kPartnerReachM; ++row) {
      const auto end = cells_.upper_bound({row, x + kPartnerReachM});
      for (auto cell = cells_.lower_bound({row, x - kPartnerReachM}); cell != end; ++cell) {
        const Eigen::Vector2d center(static_cast<double>(cell->first.second) + 0.5,
                                     static_cast<double>(row) + 0.5);
        if ((center - position).norm() > kPartnerReachM) continue;
        earlier.emplace_back(&cell->second, CountEarlier(cell->second, viewpoint));
        total += earlier.back().second;
      }
    }
    return PickEvenly(earlier, total);
  }

 private:
  // Row and column.
  std::pair<long, long> CellOf(int viewpoint) const {
    const Pose2& pose = viewpoints_[viewpoint].world_from_robot;
    return {static_cast<long>(std::floor(pose.y)), static_cast<long>(std::floor(pose.x))};
  }

  // Number of a cell's viewpoints that were passed at least kMinBetweenM before `viewpoint`.
  std::size_t CountEarlier(const std::vector<int>& cell, int viewpoint) const {
    return CountBefore(cell, viewpoints_[viewpoint].path_m - kMinBetweenM,
                       [this](int other) { return viewpoints_[other].path_m; });
  }

  static std::vector<int> PickEvenly(
      const std::vector<std::pair<const std::vector<int>*, std::size_t>>& lists,
      std::size_t total) {
    std::vector<int> picked;
    const std::size_t count = std::min(total, kPartnersBetween);
    std::size_t list = 0, before = 0;  // `before`: entries of the lists before this one
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t rank = (2 * i + 1) * total / (2 * count);
      while (rank >= before + lists[list].second) before += lists[list++].second;
      picked.push_back((*lists[list].first)[rank - before]);
    }
    return picked;
  }

  const std::vector<Viewpoint>& viewpoints_;
  std::map<std::pair<long, long>, std::vector<int>> cells_;
};

std::vector<ViewpointPair> ChoosePairs(const std::vector<Viewpoint>& viewpoints) {
  std::vector<ViewpointPair> pairs;
  const auto add = [&pairs](int first, int second, bool between_passes) {
    pairs.push_back({first, second, between_passes});
  };
  const auto path_of = [](const Viewpoint& viewpoint) { return viewpoint.path_m; };
  ViewpointGrid grid(viewpoints);
  for (int v = 0; v < static_cast<int>(viewpoints.size()); ++v) {
    const std::size_t begin = CountBefore(viewpoints, viewpoints[v].path_m - kMaxWithinM, path_of);
    const std::size_t end = CountBefore(viewpoints, viewpoints[v].path_m - kMinWithinM, path_of);
    const std::size_t count = std::min(end - begin, kPartnersWithin);
    for (std::size_t i = 0; i < count; ++i) {
      add(static_cast<int>(begin + (2 * i + 1) * (end - begin) / (2 * count)), v, false);
    }
    for (const int other : grid.Partners(v)) add(other, v, true);
    grid.Add(v);
  }
  return pairs;
}

// The middle one of the returns that are seen through.
Eigen::Vector2d ConflictingReturn(const ComparedReturns& compared, const FreeSpaceScan& scan) {
  const auto begin = compared.verdicts.begin(), end = compared.verdicts.end();
  auto left = std::count(begin, end, ReturnVerdict::kConflicts) / 2;
  const auto is_middle = [&](ReturnVerdict verdict) {
    return verdict == ReturnVerdict::kConflicts && left-- == 0;
  };
  return scan.returns()[std::find_if(begin, end, is_middle) - begin];
}

// scans: of the viewpoints.
void ComparePair(const std::vector<Viewpoint>& viewpoints,
                 const std::vector<const FreeSpaceScan*>& scans, ViewpointPair* pair) {
  ComparedReturns compared;
  const auto compare = [&](const FreeSpaceScan& viewer, const FreeSpaceScan& scan,
                           const Pose2& viewer_from_scan, Eigen::Vector2d* point) {
    const FreeSpaceConflict conflict = viewer.Compare(scan, viewer_from_scan, &compared);
    if (conflict.num_conflicting > 0) *point = viewer_from_scan * ConflictingReturn(compared, scan);
    pair->with_moving += compared.with_moving;
    return conflict;
  };
  const Pose2 first_from_second =
      Between(viewpoints[pair->first].world_from_robot, viewpoints[pair->second].world_from_robot);
  const FreeSpaceScan &first = *scans[pair->first], &second = *scans[pair->second];
  pair->first_views = compare(first, second, first_from_second, &pair->seen_by_first);
  pair->second_views = compare(second, first, first_from_second.Inverse(), &pair->seen_by_second);
}

// Each process compares the pairs whose second viewpoint is its own. moving: returns per viewpoint.
// scans: of the viewpoints of this process; null for the others.
void ComparePairs(const SlamGraph& graph, const std::vector<Viewpoint>& viewpoints,
                  const std::vector<std::vector<int>>& moving,
                  std::vector<const FreeSpaceScan*> scans, ThreadPool* pool,
                  std::vector<ViewpointPair>* pairs) {
  std::vector<std::size_t> own;
  std::vector<int> foreign;  // viewpoints
  for (std::size_t i = 0; i < pairs->size(); ++i) {
    const ViewpointPair& pair = (*pairs)[i];
    if (scans[pair.second] == nullptr) continue;
    own.push_back(i);
    if (scans[pair.first] == nullptr) foreign.push_back(pair.first);
  }
  std::vector<FreeSpaceScan> fetched_scans;
  if (graph.peers() != nullptr) {
    SortUnique(&foreign);
    std::vector<int> ids;
    ids.reserve(foreign.size());
    for (const int viewpoint : foreign) ids.push_back(viewpoints[viewpoint].scan);
    const SlamGraph fetched = FetchScans(graph, ids);
    fetched_scans.reserve(foreign.size());
    for (std::size_t i = 0; i < foreign.size(); ++i) {
      FreeSpaceScan& scan = fetched_scans.emplace_back(fetched, static_cast<int>(i));
      scan.MarkMoving(moving[foreign[i]]);
      scans[foreign[i]] = &scan;
    }
  }
  constexpr std::size_t kPairsPerChunk = 64;
  pool->ForEach(own.size(), kPairsPerChunk,
                [&](std::size_t i) { ComparePair(viewpoints, scans, &(*pairs)[own[i]]); });
  if (graph.peers() == nullptr) return;
  std::vector<std::pair<std::size_t, ViewpointPair>> compared;
  compared.reserve(own.size());
  for (const std::size_t i : own) compared.emplace_back(i, (*pairs)[i]);
  for (const auto& [i, pair] : JoinOverPeers(graph.peers(), std::move(compared))) {
    (*pairs)[i] = pair;
  }
}

void AddPlace(const Viewpoint& viewer, const Viewpoint& scan, const FreeSpaceConflict& conflict,
              const Eigen::Vector2d& point_in_viewer, MapConsistency* consistency) {
  if (conflict.num_conflicting < kMinConflictingReturns ||
      conflict.Share() <= MapConsistency::kMaxRatio * consistency->ExplicableShare()) {
    return;
  }
  consistency->places.push_back(
      {viewer.scan, scan.scan, viewer.world_from_robot * point_in_viewer});
}

// Conflicts over all pairs of some places, both ways.
struct PlaceConflict {
  FreeSpaceConflict at_rest;
  FreeSpaceConflict with_moving;

  PlaceConflict& operator+=(const PlaceConflict& other) {
    at_rest += other.at_rest;
    with_moving += other.with_moving;
    return *this;
  }
  PlaceConflict& operator-=(const PlaceConflict& other) {
    at_rest -= other.at_rest;
    with_moving -= other.with_moving;
    return *this;
  }
};

PlaceConflict ConflictOf(const ViewpointPair& pair) { return {pair.AtRest(), pair.with_moving}; }

// Keeps the worst of the conflicts that it is shown.
class PeakFinder {
 public:
  explicit PeakFinder(double explicable_share) : explicable_share_(explicable_share) {}

  void Try(const PlaceConflict& conflict, int pose) {
    AddShare(conflict.at_rest, &shares_at_rest_);
    AddShare(conflict.with_moving, &shares_with_moving_);
    if (conflict.at_rest.num_compared == 0) return;
    const double ratio = MapConsistency::RatioOf(conflict.at_rest, explicable_share_);
    ++num_tried_;
    if (ratio > MapConsistency::kMaxRatio) ++num_contradicted_;
    if (ratio <= worst_) return;
    worst_ = ratio;
    peak_.conflict = conflict.at_rest;
    peak_.pose = pose;
  }

  double ContradictedShare() const {
    return num_tried_ > 0 ? static_cast<double>(num_contradicted_) / num_tried_ : 0.0;
  }

  double UsualRatioAtRest() const { return MedianRatio(shares_at_rest_); }

  ConflictPeak Peak() const {
    return {peak_.conflict, peak_.pose, MedianRatio(shares_with_moving_)};
  }

 private:
  // Only stretches where much was compared tell what is usual.
  static void AddShare(const FreeSpaceConflict& conflict, std::vector<double>* shares) {
    if (conflict.num_compared >= MapConsistency::kPriorReturns) shares->push_back(conflict.Share());
  }

  double MedianRatio(const std::vector<double>& shares) const {
    return shares.empty() ? 0.0 : Median(shares) / explicable_share_;
  }

  double explicable_share_;
  double worst_ = 0.0;
  int num_tried_ = 0, num_contradicted_ = 0;
  std::vector<double> shares_at_rest_, shares_with_moving_;
  ConflictPeak peak_;
};

// Compares the two sides of each viewpoint by the pairs of one pass that reach across it or end
// there.
ConflictPeak WorstWithin(const std::vector<Viewpoint>& viewpoints,
                         const std::vector<ViewpointPair>& pairs, double explicable_share) {
  std::vector<PlaceConflict> change(viewpoints.size());
  for (const ViewpointPair& pair : pairs) {
    if (pair.between_passes) continue;
    change[pair.first] += ConflictOf(pair);
    change[pair.second] -= ConflictOf(pair);
  }
  PeakFinder finder(explicable_share);
  PlaceConflict across;
  for (std::size_t v = 0; v < viewpoints.size(); ++v) {
    across += change[v];
    finder.Try(across, viewpoints[v].pose);
  }
  return finder.Peak();
}

// Compares the stretch around each viewpoint with other passes.
void FindWorstBetween(const std::vector<Viewpoint>& viewpoints,
                      const std::vector<ViewpointPair>& pairs, MapConsistency* consistency) {
  std::vector<PlaceConflict> of_viewpoint(viewpoints.size());
  for (const ViewpointPair& pair : pairs) {
    if (!pair.between_passes) continue;
    of_viewpoint[pair.first] += ConflictOf(pair);
    of_viewpoint[pair.second] += ConflictOf(pair);
  }
  PeakFinder finder(consistency->ExplicableShare());
  PlaceConflict stretch;
  std::size_t begin = 0, end = 0;
  for (const Viewpoint& middle : viewpoints) {
    while (end < viewpoints.size() && viewpoints[end].path_m <= middle.path_m + 0.5 * kStretchM) {
      stretch += of_viewpoint[end++];
    }
    while (viewpoints[begin].path_m < middle.path_m - 0.5 * kStretchM) {
      stretch -= of_viewpoint[begin++];
    }
    finder.Try(stretch, middle.pose);
  }
  consistency->contradicted_share = finder.ContradictedShare();
  consistency->usual_ratio_at_rest = finder.UsualRatioAtRest();
  consistency->worst_between = finder.Peak();
}

}  // namespace

ConsistencyMeter::ConsistencyMeter(const SlamGraph& graph,
                                   const std::vector<Pose2>& world_from_robot, ThreadPool* pool)
    : graph_(graph),
      scans_(ScansAlongPath(graph, world_from_robot, kViewpointSpacingM, kViewpointSpacingRad)) {
  const DefaultFloatEnvironment float_environment;
  free_space_.resize(scans_.size());
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const int scan = OwnScan(graph, scans_[i]);
    if (scan >= 0) free_space_[i].emplace(graph, scan);
  }
  // Asked for free space only: the surfaces are empty.
  const ScanSurfaces surfaces(graph, std::vector<PackedSurface>(graph.all_scans().size()));
  moving_ = FindMovingReturns(surfaces, scans_, scans_, world_from_robot, pool);
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    if (free_space_[i]) free_space_[i]->MarkMoving(moving_[i]);
  }
}

MapConsistency ConsistencyMeter::Measure(const std::vector<Pose2>& world_from_robot,
                                         ThreadPool* pool) const {
  const DefaultFloatEnvironment float_environment;
  const std::vector<Viewpoint> viewpoints = PlaceViewpoints(graph_, scans_, world_from_robot);
  std::vector<ViewpointPair> pairs = ChoosePairs(viewpoints);
  std::vector<const FreeSpaceScan*> scans;
  for (const auto& scan : free_space_) scans.push_back(scan ? &*scan : nullptr);
  ComparePairs(graph_, viewpoints, moving_, std::move(scans), pool, &pairs);
  MapConsistency consistency;
  for (const Viewpoint& viewpoint : viewpoints) {
    consistency.viewpoints.emplace_back().pose = viewpoint.pose;
  }
  for (const ViewpointPair& pair : pairs) {
    const FreeSpaceConflict conflict = pair.AtRest();
    (pair.between_passes ? consistency.between_passes : consistency.within_pass) += conflict;
    for (const int end : {pair.first, pair.second}) {
      ViewpointConflict& of_end = consistency.viewpoints[end];
      (pair.between_passes ? of_end.between_passes : of_end.within_pass) += conflict;
    }
    ++(pair.between_passes ? consistency.num_pairs_between : consistency.num_pairs_within);
  }
  consistency.worst_within = WorstWithin(viewpoints, pairs, consistency.ExplicableShare());
  FindWorstBetween(viewpoints, pairs, &consistency);
  for (const ViewpointPair& pair : pairs) {
    const Viewpoint &first = viewpoints[pair.first], &second = viewpoints[pair.second];
    AddPlace(first, second, pair.first_views, pair.seen_by_first, &consistency);
    AddPlace(second, first, pair.second_views, pair.seen_by_second, &consistency);
  }
  return consistency;
}

std::vector<MapConsistency> ConsistencyMeter::MeasureEach(
    const std::vector<std::vector<Pose2>>& maps, ThreadPool* pool) const {
  std::vector<MapConsistency> consistencies(maps.size());
  if (graph_.peers() != nullptr) {
    for (std::size_t i = 0; i < maps.size(); ++i) consistencies[i] = Measure(maps[i], pool);
    return consistencies;
  }
  pool->ForEachChunk(maps.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    ThreadPool one_thread(1);
    consistencies[i] = Measure(maps[i], &one_thread);
  });
  return consistencies;
}

MapConsistency MeasureMapConsistency(const SlamGraph& graph,
                                     const std::vector<Pose2>& world_from_robot, ThreadPool* pool) {
  return ConsistencyMeter(graph, world_from_robot, pool).Measure(world_from_robot, pool);
}

}  // namespace plumbline
