#include "plumbline/solvers/loop_closure/consistency_meter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/sort_unique.h"
#include "plumbline/solvers/loop_closure/moving_returns.h"
#include "plumbline/solvers/loop_closure/scans_along_path.h"

namespace plumbline {
namespace {

// From viewpoint to viewpoint.
constexpr double kViewpointSpacingM = 0.5;
constexpr double kSpacingRad = 0.5;

// Scans of one pass differ by what moves and by noise, hardly by the drift between them.
constexpr double kMinWithinM = 1.0;
constexpr double kMaxWithinM = 5.0;
constexpr std::size_t kPartnersWithin = 4;
// Another pass has left the room or turned round since, and stands where it sees the same surfaces.
constexpr double kMinBetweenM = 8.0;
constexpr double kPartnerReachM = 4.0;
constexpr std::size_t kPartnersBetween = 8;

// A wrong closure bends a part of the map only: a mean over all of it would hide the part.
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
  FreeSpaceConflict with_moving = {};  // both ways, and with the returns of what moves
  // A conflicting return each, in the frame of the viewer's robot.
  Eigen::Vector2d seen_by_first = Eigen::Vector2d::Zero();
  Eigen::Vector2d seen_by_second = Eigen::Vector2d::Zero();
};

// How many of the entries, in order of the path, come before `path_m`.
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

  void Add(int viewpoint) {
    cells_[Id(CellOf(viewpoint, 0), CellOf(viewpoint, 1))].push_back(viewpoint);
  }

  // At most kPartnersBetween of the viewpoints around `viewpoint` that were added and belong to
  // earlier passes, evenly spread over places and passes.
  std::vector<int> Partners(int viewpoint) const {
    constexpr std::int64_t kReachCells = static_cast<std::int64_t>(kPartnerReachM);
    const Pose2& pose = viewpoints_[viewpoint].world_from_robot;
    const std::int64_t x = CellOf(viewpoint, 0), y = CellOf(viewpoint, 1);
    std::vector<std::pair<const std::vector<int>*, std::size_t>> earlier;
    std::size_t total = 0;
    for (std::int64_t row = y - kReachCells; row <= y + kReachCells; ++row) {
      for (std::int64_t column = x - kReachCells; column <= x + kReachCells; ++column) {
        const auto cell = cells_.find(Id(column, row));
        if (cell == cells_.end()) continue;
        const double center_x = static_cast<double>(column) + 0.5;
        const double center_y = static_cast<double>(row) + 0.5;
        if (std::hypot(center_x - pose.x, center_y - pose.y) > kPartnerReachM) continue;
        earlier.emplace_back(&cell->second, CountEarlier(cell->second, viewpoint));
        total += earlier.back().second;
      }
    }
    return PickEvenly(earlier, total);
  }

 private:
  std::int64_t CellOf(int viewpoint, int axis) const {
    return static_cast<std::int64_t>(
        std::floor(viewpoints_[viewpoint].world_from_robot.translation()[axis]));
  }
  static std::uint64_t Id(std::int64_t x, std::int64_t y) {
    return static_cast<std::uint64_t>(y) << 32 ^ (static_cast<std::uint64_t>(x) & 0xffffffffu);
  }

  // How many of a cell's viewpoints were passed at least kMinBetweenM before `viewpoint`.
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
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
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

// Of the returns that are seen through, the one in the middle.
Eigen::Vector2d ConflictingReturn(const ComparedReturns& compared, const FreeSpaceScan& scan) {
  const auto begin = compared.verdicts.begin(), end = compared.verdicts.end();
  auto left = std::count(begin, end, ReturnVerdict::kConflicts) / 2;
  const auto is_middle = [&](ReturnVerdict verdict) {
    return verdict == ReturnVerdict::kConflicts && left-- == 0;
  };
  return scan.returns()[std::find_if(begin, end, is_middle) - begin];
}

// scans: of the viewpoints.
void ComparePairs(const std::vector<Viewpoint>& viewpoints,
                  const std::vector<const FreeSpaceScan*>& scans, ThreadPool* pool,
                  std::vector<ViewpointPair>* pairs) {
  constexpr std::size_t kPairsPerChunk = 64;
  pool->ForEachChunk(
      pairs->size(), kPairsPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        ComparedReturns compared;
        // Returns the counts of one way, and adds those with moving returns to the pair's.
        const auto compare = [&](const FreeSpaceScan& viewer, const FreeSpaceScan& scan,
                                 const Pose2& viewer_from_scan, Eigen::Vector2d* point,
                                 ViewpointPair* pair) {
          const FreeSpaceConflict conflict = viewer.Compare(scan, viewer_from_scan, &compared);
          if (conflict.num_conflicting > 0) {
            *point = viewer_from_scan * ConflictingReturn(compared, scan);
          }
          pair->with_moving += compared.with_moving;
          return conflict;
        };
        for (std::size_t i = begin; i < end; ++i) {
          ViewpointPair& pair = (*pairs)[i];
          const Pose2 first_from_second = Between(viewpoints[pair.first].world_from_robot,
                                                  viewpoints[pair.second].world_from_robot);
          const FreeSpaceScan &first = *scans[pair.first], &second = *scans[pair.second];
          pair.first_views = compare(first, second, first_from_second, &pair.seen_by_first, &pair);
          pair.second_views =
              compare(second, first, first_from_second.Inverse(), &pair.seen_by_second, &pair);
        }
      });
}

// Of the pairs whose second viewpoint is one of this process, the scans that other processes have.
std::vector<int> ForeignFirsts(const SlamGraph& graph, const std::vector<Viewpoint>& viewpoints,
                               const std::vector<ViewpointPair>& pairs) {
  std::vector<int> firsts;
  for (const ViewpointPair& pair : pairs) {
    const bool is_own = graph.HasScansOf(viewpoints[pair.second].pose);
    if (is_own && !graph.HasScansOf(viewpoints[pair.first].pose)) firsts.push_back(pair.first);
  }
  SortUnique(&firsts);
  return firsts;
}

// The conflicts of one pair as numbers, to be added up with those of processes that did not compare
// it, all zero.
constexpr std::size_t kNumbersPerPair = 10;

void ToNumbers(const ViewpointPair& pair, double* numbers) {
  const double values[kNumbersPerPair] = {static_cast<double>(pair.first_views.num_compared),
                                          static_cast<double>(pair.first_views.num_conflicting),
                                          static_cast<double>(pair.second_views.num_compared),
                                          static_cast<double>(pair.second_views.num_conflicting),
                                          pair.seen_by_first.x(),
                                          pair.seen_by_first.y(),
                                          pair.seen_by_second.x(),
                                          pair.seen_by_second.y(),
                                          static_cast<double>(pair.with_moving.num_compared),
                                          static_cast<double>(pair.with_moving.num_conflicting)};
  std::copy_n(values, kNumbersPerPair, numbers);
}

void FromNumbers(const double* numbers, ViewpointPair* pair) {
  pair->first_views = {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
  pair->second_views = {static_cast<int>(numbers[2]), static_cast<int>(numbers[3])};
  pair->seen_by_first = {numbers[4], numbers[5]};
  pair->seen_by_second = {numbers[6], numbers[7]};
  pair->with_moving = {static_cast<int>(numbers[8]), static_cast<int>(numbers[9])};
}

// Each process compares the pairs whose second viewpoint is its own. moving: returns per viewpoint.
// scans: of the viewpoints of this process; null for the others.
void ComparePairsOverPeers(const SlamGraph& graph, const std::vector<Viewpoint>& viewpoints,
                           const std::vector<std::vector<int>>& moving,
                           std::vector<const FreeSpaceScan*> scans, ThreadPool* pool,
                           std::vector<ViewpointPair>* pairs) {
  const std::vector<int> foreign = ForeignFirsts(graph, viewpoints, *pairs);
  std::vector<int> ids;
  ids.reserve(foreign.size());
  for (const int viewpoint : foreign) ids.push_back(viewpoints[viewpoint].scan);
  const SlamGraph fetched = FetchScans(graph, ids);
  std::vector<FreeSpaceScan> fetched_scans;
  fetched_scans.reserve(foreign.size());
  for (std::size_t i = 0; i < foreign.size(); ++i) {
    FreeSpaceScan& scan = fetched_scans.emplace_back(fetched, static_cast<int>(i));
    scan.MarkMoving(moving[foreign[i]]);
    scans[foreign[i]] = &scan;
  }
  std::vector<ViewpointPair> own;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < pairs->size(); ++i) {
    if (!graph.HasScansOf(viewpoints[(*pairs)[i].second].pose)) continue;
    own.push_back((*pairs)[i]);
    places.push_back(i);
  }
  ComparePairs(viewpoints, scans, pool, &own);
  std::vector<double> numbers(kNumbersPerPair * pairs->size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    ToNumbers(own[i], &numbers[kNumbersPerPair * places[i]]);
  }
  SumOverPeers(graph.peers(), &numbers);
  for (std::size_t i = 0; i < pairs->size(); ++i) {
    FromNumbers(&numbers[kNumbersPerPair * i], &(*pairs)[i]);
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

FreeSpaceConflict BothWays(const ViewpointPair& pair) {
  FreeSpaceConflict conflict = pair.first_views;
  conflict += pair.second_views;
  return conflict;
}

PlaceConflict ConflictOf(const ViewpointPair& pair) { return {BothWays(pair), pair.with_moving}; }

// The shares of stretches where much was compared.
class Shares {
 public:
  void Add(const FreeSpaceConflict& conflict) {
    if (conflict.num_compared >= MapConsistency::kPriorReturns) shares_.push_back(conflict.Share());
  }

  double Median() {
    if (shares_.empty()) return 0.0;
    const auto median = shares_.begin() + static_cast<std::ptrdiff_t>(shares_.size() / 2);
    std::nth_element(shares_.begin(), median, shares_.end());
    return *median;
  }

 private:
  std::vector<double> shares_;
};

// Keeps the worst of the conflicts that it is shown.
class PeakFinder {
 public:
  explicit PeakFinder(double explicable_share) : explicable_share_(explicable_share) {}

  void Try(const PlaceConflict& conflict, int pose) {
    at_rest_.Add(conflict.at_rest);
    with_moving_.Add(conflict.with_moving);
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

  double UsualRatioAtRest() { return at_rest_.Median() / explicable_share_; }

  ConflictPeak TakePeak() {
    peak_.usual_ratio = with_moving_.Median() / explicable_share_;
    return peak_;
  }

 private:
  double explicable_share_;
  double worst_ = 0.0;
  int num_tried_ = 0, num_contradicted_ = 0;
  Shares at_rest_, with_moving_;
  ConflictPeak peak_;
};

// Of the pairs of one pass, those that lie on either side of a viewpoint, or end there.
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
  return finder.TakePeak();
}

// Of the stretches around each viewpoint.
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
  consistency->worst_between = finder.TakePeak();
}

}  // namespace

ConsistencyMeter::ConsistencyMeter(const SlamGraph& graph,
                                   const std::vector<Pose2>& world_from_robot, ThreadPool* pool)
    : graph_(graph),
      scans_(ScansAlongPath(graph, world_from_robot, kViewpointSpacingM, kSpacingRad)) {
  const DefaultFloatEnvironment float_environment;
  free_space_.resize(scans_.size());
  std::size_t viewpoint = 0;
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    while (viewpoint < scans_.size() && scans_[viewpoint] < graph.IdAmongAll(scan)) ++viewpoint;
    if (viewpoint == scans_.size()) break;
    if (scans_[viewpoint] == graph.IdAmongAll(scan)) free_space_[viewpoint].emplace(graph, scan);
  }
  moving_ = FindMovingReturns(graph, scans_, world_from_robot, free_space_, pool);
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
  if (graph_.peers() == nullptr) {
    ComparePairs(viewpoints, scans, pool, &pairs);
  } else {
    ComparePairsOverPeers(graph_, viewpoints, moving_, std::move(scans), pool, &pairs);
  }
  MapConsistency consistency;
  for (const Viewpoint& viewpoint : viewpoints) {
    consistency.viewpoints.emplace_back();
    consistency.viewpoints.back().pose = viewpoint.pose;
  }
  for (const ViewpointPair& pair : pairs) {
    const FreeSpaceConflict conflict = BothWays(pair);
    FreeSpaceConflict& sum =
        pair.between_passes ? consistency.between_passes : consistency.within_pass;
    sum += conflict;
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
