#include "plumbline/solvers/seeding/loop_closure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/options_check.h"
#include "plumbline/solvers/seeding/correlative_matcher.h"
#include "plumbline/solvers/seeding/free_space.h"
#include "plumbline/solvers/seeding/local_map.h"
#include "plumbline/solvers/seeding/match_covariance.h"

namespace plumbline {
namespace {

constexpr double kScanCellM = 0.05;
constexpr double kMapCellM = 0.03;
// The correlative search finds a pose to about its cell; the fine matching starts from there.
constexpr double kFineGateStartM = 0.3;
// A second peak lies at least this far from the first; nearer ones are its flank.
constexpr double kPeakRadiusM = 0.7;
constexpr double kPeakAngleRad = 0.3;
// A second peak is looked for at least this far around: repeated rooms are a few metres apart.
constexpr double kPeakWindowM = 6.0;

class CandidateTester {
 public:
  CandidateTester(const LoopClosureOptions& options, const SlamGraph& graph,
                  const std::vector<SurfacePoints>& surfaces, const std::vector<KeyScan>& key_scans,
                  const std::vector<Pose2>& world_from_key)
      : options_(options),
        graph_(graph),
        surfaces_(surfaces),
        key_scans_(key_scans),
        world_from_key_(world_from_key) {}

  // Sets *closure and returns true if the candidate is one.
  bool Test(const LoopCandidate& candidate, RelativePoseConstraint* closure) const {
    const LocalMap map = SubmapAround(candidate.first, options_.map_path_m, kMapCellM);
    const LocalMap scan = SubmapAround(candidate.second, options_.scan_path_m, kScanCellM);
    const CorrelativeMatcher search(map.points(), options_.search_cell_m);
    const SearchWindow window{
        Between(world_from_key_[candidate.first], world_from_key_[candidate.second]),
        candidate.drift_m, candidate.drift_rad};
    const CorrelativeMatch coarse = search.Search(scan.points(), window, options_.min_search_score);
    if (!coarse.found) return false;

    ScanMatchOptions matching;
    matching.coarse_gate_m = kFineGateStartM;
    PosePrediction start;
    start.world_from_robot = coarse.map_from_scan;
    const ScanMatch fine = MatchScan(map, scan.points(), start, matching);
    const bool wide = candidate.drift_m > options_.wide_window_m;
    if (fine.inlier_ratio < (wide ? options_.min_inlier_ratio_wide : options_.min_inlier_ratio)) {
      return false;
    }
    if (ConflictShare(candidate, fine.world_from_robot) > options_.max_free_space_conflict) {
      return false;
    }
    if (wide && HasSecondPeak(search, scan.points(), window, coarse)) return false;
    *closure = {candidate.first, candidate.second, fine.world_from_robot,
                MatchCovariance(fine.information)};
    return true;
  }

 private:
  // Points of the key scans within path_m of the center, in the frame of the center.
  LocalMap SubmapAround(int center, double path_m, double cell_m) const {
    std::vector<const SurfacePoints*> scans{&surfaces_[key_scans_[center].scan]};
    std::vector<Pose2> poses{Pose2()};
    const auto add = [&](int k) {
      if (std::abs(key_scans_[k].path_m - key_scans_[center].path_m) > path_m) return false;
      scans.push_back(&surfaces_[key_scans_[k].scan]);
      poses.push_back(Between(world_from_key_[center], world_from_key_[k]));
      return true;
    };
    const int num_keys = static_cast<int>(key_scans_.size());
    for (int k = center - 1; k >= 0 && add(k); --k) {
    }
    for (int k = center + 1; k < num_keys && add(k); ++k) {
    }
    LocalMap map(cell_m);
    map.Rebuild(scans, poses);
    return map;
  }

  // The key scan and the ones before and after it, as far as they belong to the same visit.
  std::vector<int> Neighbours(int center) const {
    std::vector<int> keys;
    for (int k = center - 1; k <= center + 1; ++k) {
      if (k < 0 || k >= static_cast<int>(key_scans_.size())) continue;
      const double path_m = std::abs(key_scans_[k].path_m - key_scans_[center].path_m);
      if (path_m <= options_.map_path_m) keys.push_back(k);
    }
    return keys;
  }

  // Over the pairs of key scans next to the two, both ways.
  double ConflictShare(const LoopCandidate& candidate, const Pose2& first_from_second) const {
    FreeSpaceConflict conflict;
    for (const int a : Neighbours(candidate.first)) {
      const Pose2 a_from_second =
          Between(world_from_key_[a], world_from_key_[candidate.first]) * first_from_second;
      for (const int b : Neighbours(candidate.second)) {
        const Pose2 a_from_b =
            a_from_second * Between(world_from_key_[candidate.second], world_from_key_[b]);
        const int scan_a = key_scans_[a].scan, scan_b = key_scans_[b].scan;
        conflict += CompareFreeSpace(graph_, scan_a, scan_b, a_from_b);
        conflict += CompareFreeSpace(graph_, scan_b, scan_a, a_from_b.Inverse());
      }
    }
    return conflict.Share();
  }

  bool HasSecondPeak(const CorrelativeMatcher& search, const SurfacePoints& scan,
                     SearchWindow window, const CorrelativeMatch& best) const {
    window.half_width_m = std::max(window.half_width_m, kPeakWindowM);
    return search
        .SearchElsewhere(scan, window, options_.max_second_peak * best.score, best.map_from_scan,
                         kPeakRadiusM, kPeakAngleRad)
        .found;
  }

  const LoopClosureOptions& options_;
  const SlamGraph& graph_;
  const std::vector<SurfacePoints>& surfaces_;
  const std::vector<KeyScan>& key_scans_;
  const std::vector<Pose2>& world_from_key_;
};

}  // namespace

bool LoopClosureOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(candidates);
  PLUMBLINE_CHECK_FINITE_OPTION(scan_path_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(map_path_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(search_cell_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(min_search_score, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(min_inlier_ratio, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(min_inlier_ratio_wide, >=, min_inlier_ratio);
  PLUMBLINE_CHECK_FINITE_OPTION(wide_window_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(max_free_space_conflict, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(max_second_peak, >, 0.0);
  return true;
}

std::vector<RelativePoseConstraint> CloseLoops(const LoopClosureOptions& options,
                                               const SlamGraph& graph,
                                               const std::vector<SurfacePoints>& surfaces,
                                               const std::vector<KeyScan>& key_scans,
                                               const std::vector<Pose2>& world_from_key,
                                               const std::vector<LoopCandidate>& candidates,
                                               ThreadPool* pool) {
  const CandidateTester tester(options, graph, surfaces, key_scans, world_from_key);
  std::vector<RelativePoseConstraint> tested(candidates.size());
  std::vector<char> accepted(candidates.size(), 0);
  pool->ForEachChunk(candidates.size(), 1, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      accepted[i] = tester.Test(candidates[i], &tested[i]) ? 1 : 0;
    }
  });
  std::vector<RelativePoseConstraint> closures;
  for (std::size_t i = 0; i < tested.size(); ++i) {
    if (accepted[i] != 0) closures.push_back(tested[i]);
  }
  return closures;
}

}  // namespace plumbline
