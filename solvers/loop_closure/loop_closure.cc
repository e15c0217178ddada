#include "plumbline/solvers/loop_closure/loop_closure.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/correlative_matcher.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/match_profile.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {
namespace {

// Path [m] on either side of the revisiting keyframe that is matched, and of the earlier one that
// it is matched against. In wide searches both are of the latter size: chance has more room there.
constexpr double kScanPathM = 0.5;
constexpr double kSubmapPathM = 5.0;
// Extent of the map of a wide search [m]: a return kilometres away must not blow up its grid.
constexpr double kSearchReachM = 150.0;
// Cells [m] of the correlative search for the best place, and for all places.
constexpr double kSearchCellM = 0.1;
constexpr double kPlaceCellM = 0.2;
// First gate of the fine matching [m]: the correlative search finds a pose to about its cell.
constexpr double kFineGateStartM = 0.3;
constexpr PeakSize kPeak{LoopAcceptance::kPeakRadiusM, LoopAcceptance::kPeakAngleRad};

class CandidateTester {
 public:
  CandidateTester(const ScanSurfaces& surfaces, const KeyframeGraph& keyframe_graph)
      : surfaces_(surfaces), keys_(keyframe_graph) {}

  // Tests candidates[i] for all i of a group of GroupBySurroundings, which share their search.
  void TestGroup(const std::vector<LoopCandidate>& candidates,
                 const std::vector<std::size_t>& group,
                 std::vector<std::vector<TestedCandidate>>* tested) const {
    const LoopCandidate& any = candidates[group.front()];
    double half_width_m = any.wide() ? LoopAcceptance::kPeakWindowM : 0.0;
    for (const std::size_t i : group) half_width_m = std::max(half_width_m, candidates[i].drift_m);
    LocalMap map;
    if (!any.wide()) map = SubmapAround(any.first, kSubmapPathM);
    const CorrelativeMatcher search(
        any.wide() ? PointsOf(any.surroundings, any.first) : map.points(), kSearchCellM,
        half_width_m);
    for (const std::size_t i : group) (*tested)[i] = {Test(candidates[i], map, search)};
  }

  CorrelativeMatcher PlacesAround(const LoopCandidate& candidate) const {
    return {PointsOf(candidate.surroundings, candidate.first), kPlaceCellM, candidate.drift_m};
  }

  // search: PlacesAround this candidate or one that is sought alike.
  std::vector<TestedCandidate> FindPlaces(const CorrelativeMatcher& search,
                                          const LoopCandidate& candidate, int max_places) const {
    const LocalMap scan = ScanOf(candidate);
    std::vector<TestedCandidate> places;
    for (const CorrelativeMatch& peak :
         search.SearchPeaks(scan.points(), WindowOf(candidate), LoopAcceptance::kMinPlaceScore,
                            max_places, kPeak)) {
      const TestedCandidate place = TestPlace(candidate, scan, peak.map_from_scan);
      if (place.inlier_ratio >= LoopAcceptance::kMinPlaceInlierRatio) places.push_back(place);
    }
    return places;
  }

 private:
  // map: around the earlier keyframe, unless the candidate is wide. search: of where it may be.
  TestedCandidate Test(const LoopCandidate& candidate, const LocalMap& map,
                       const CorrelativeMatcher& search) const {
    const LocalMap scan = ScanOf(candidate);
    const SearchWindow window = WindowOf(candidate);
    const CorrelativeMatch coarse =
        search.Search(scan.points(), window, LoopAcceptance::kMinSearchScore);
    if (!coarse.found) return NoMatch(candidate);

    TestedCandidate tested =
        candidate.wide() ? TestPlace(candidate, scan, coarse.map_from_scan)
                         : TestFit(candidate, NoMatch(candidate), map, scan, coarse.map_from_scan);
    if (tested.outcome == ClosureOutcome::kAccepted && candidate.wide() &&
        (coarse.gave_up || HasSecondPeak(search, scan.points(), window, coarse))) {
      tested.outcome = ClosureOutcome::kAmbiguous;
    }
    return tested;
  }

  Pose2 KeyFromKey(int a, int b) const {
    return Between(keys_.world_from_key[a], keys_.world_from_key[b]);
  }

  SearchWindow WindowOf(const LoopCandidate& candidate) const {
    const Pose2 center =
        candidate.unknown ? Pose2() : KeyFromKey(candidate.first, candidate.second);
    return {center, candidate.drift_m, candidate.drift_rad};
  }

  LocalMap ScanOf(const LoopCandidate& candidate) const {
    return SubmapAround(candidate.second, candidate.wide() ? kSubmapPathM : kScanPathM);
  }

  static TestedCandidate NoMatch(const LoopCandidate& candidate) {
    TestedCandidate tested;
    tested.edge.from = candidate.first;
    tested.edge.to = candidate.second;
    return tested;
  }

  // Tests the place that a wide search found, by the keyframe nearest to it.
  TestedCandidate TestPlace(const LoopCandidate& candidate, const LocalMap& scan,
                            const Pose2& first_from_scan) const {
    TestedCandidate tested = NoMatch(candidate);
    tested.edge.from = NearestKey(candidate.surroundings, candidate.first, first_from_scan);
    return TestFit(candidate, tested, SubmapAround(tested.edge.from, kSubmapPathM), scan,
                   KeyFromKey(tested.edge.from, candidate.first) * first_from_scan);
  }

  // map: around the earlier keyframe of `tested`. start: pose of the scan in it.
  TestedCandidate TestFit(const LoopCandidate& candidate, TestedCandidate tested,
                          const LocalMap& map, const LocalMap& scan, const Pose2& start) const {
    PosePrediction prediction;
    prediction.world_from_robot = start;
    ScanMatchOptions matching;
    matching.coarse_gate_m = kFineGateStartM;
    ScanMatch fine = MatchScan(map, scan.points(), prediction, matching);
    tested.edge.covariance = fine.inlier_ratio >= LoopAcceptance::kTentativeInlierRatio
                                 ? ProfileMatch(map, scan.points(), matching, &fine)
                                 : MatchCovariance(fine.information);
    tested.edge.from_from_to = fine.world_from_robot;
    tested.inlier_ratio = fine.inlier_ratio;
    if (tested.inlier_ratio >= LoopAcceptance::kTentativeInlierRatio) {
      tested.conflict = ConflictShare(tested.edge);
    }
    const double min_inlier_ratio =
        candidate.wide() ? LoopAcceptance::kMinInlierRatioWide : LoopAcceptance::kMinInlierRatio;
    if (tested.inlier_ratio < min_inlier_ratio) {
      tested.outcome = ClosureOutcome::kLowOverlap;
    } else if (tested.conflict > LoopAcceptance::kMaxFreeSpaceConflict) {
      tested.outcome = ClosureOutcome::kFreeSpaceConflict;
    } else {
      tested.outcome = ClosureOutcome::kAccepted;
    }
    return tested;
  }

  // Points of the keyframes within path_m of the center, in the frame of the center.
  LocalMap SubmapAround(int center, double path_m) const {
    std::vector<const PackedSurface*> scans{&surfaces_.Kept(keys_.keyframes[center].scan)};
    std::vector<Pose2> poses{Pose2()};
    for (const int k : Neighbours(center, path_m)) {
      if (k == center) continue;
      scans.push_back(&surfaces_.Kept(keys_.keyframes[k].scan));
      poses.push_back(KeyFromKey(center, k));
    }
    LocalMap map;
    map.Rebuild(scans, poses);
    return map;
  }

  // Keyframes within path_m of the center, up to a suspect edge: scans from beyond it would only
  // confirm it.
  std::vector<int> Neighbours(int center, double path_m) const {
    const auto in_reach = [&](int k, int edge) {
      return !keys_.sequential[edge].in_question && !keys_.sequential[edge].between_sessions &&
             std::abs(keys_.keyframes[k].path_m - keys_.keyframes[center].path_m) <= path_m;
    };
    int low = center, high = center;
    while (low > 0 && in_reach(low - 1, low - 1)) --low;
    while (high + 1 < keys_.size() && in_reach(high + 1, high)) ++high;
    std::vector<int> keys;
    for (int k = low; k <= high; ++k) keys.push_back(k);
    return keys;
  }

  SurfacePoints PointsOf(const std::vector<int>& keys, int frame) const {
    SurfacePoints points;
    for (const int k : keys) {
      const FrameChange frame_from_key(KeyFromKey(frame, k));
      const PackedSurface& surface = surfaces_.Kept(keys_.keyframes[k].scan);
      for (std::size_t i = 0; i < surface.size(); ++i) {
        const SurfacePoint in_frame = frame_from_key * surface[i];
        if (in_frame.position.cwiseAbs().maxCoeff() <= kSearchReachM) points.push_back(in_frame);
      }
    }
    return points;
  }

  int NearestKey(const std::vector<int>& keys, int frame, const Pose2& frame_from_robot) const {
    const auto view_distance_m = [&](int k) {
      const Pose2 apart = Between(KeyFromKey(frame, k), frame_from_robot);
      return ViewDistanceM(std::hypot(apart.x, apart.y), apart.yaw);
    };
    return *std::min_element(keys.begin(), keys.end(),
                             [&](int a, int b) { return view_distance_m(a) < view_distance_m(b); });
  }

  // Conflict of the two places of an edge: over all pairs of a keyframe next to the one and one
  // next to the other.
  double ConflictShare(const RelativePoseConstraint& edge) const {
    const std::vector<int> keys_a = NextTo(edge.from), keys_b = NextTo(edge.to);
    std::vector<FreeSpaceScan> scans_b;
    scans_b.reserve(keys_b.size());
    for (const int b : keys_b) scans_b.push_back(surfaces_.FreeSpaceOf(keys_.keyframes[b].scan));
    FreeSpaceConflict conflict;
    for (const int a : keys_a) {
      const FreeSpaceScan scan_a = surfaces_.FreeSpaceOf(keys_.keyframes[a].scan);
      const Pose2 a_from_to = KeyFromKey(a, edge.from) * edge.from_from_to;
      for (std::size_t b = 0; b < keys_b.size(); ++b) {
        conflict += CompareBothWays(scan_a, scans_b[b], a_from_to * KeyFromKey(edge.to, keys_b[b]));
      }
    }
    return conflict.Share();
  }

  // The keyframe and the ones right before and after it, as far as they are of the same visit.
  std::vector<int> NextTo(int center) const {
    std::vector<int> keys = Neighbours(center, kSubmapPathM);
    keys.erase(
        std::remove_if(keys.begin(), keys.end(), [&](int k) { return std::abs(k - center) > 1; }),
        keys.end());
    return keys;
  }

  bool HasSecondPeak(const CorrelativeMatcher& search, const SurfacePoints& scan,
                     SearchWindow window, const CorrelativeMatch& best) const {
    window.half_width_m = std::max(window.half_width_m, LoopAcceptance::kPeakWindowM);
    const std::vector<CorrelativeMatch> peaks =
        search.SearchPeaks(scan, window, LoopAcceptance::kMaxSecondPeak * best.score, 2, kPeak);
    return peaks.size() != 1 || peaks.front().gave_up;
  }

  const ScanSurfaces& surfaces_;
  const KeyframeGraph& keys_;
};

// Whether the same search finds the places of both.
bool AreSoughtAlike(const LoopCandidate& a, const LoopCandidate& b) {
  return a.first == b.first && a.drift_m == b.drift_m && a.surroundings == b.surroundings;
}

// Candidates, by index, with the same earlier keyframe, and each wide one by itself. Large groups
// come first, so that threads and processes that share them end at about the same time.
std::vector<std::vector<std::size_t>> GroupBySurroundings(
    const std::vector<LoopCandidate>& candidates) {
  std::vector<std::vector<std::size_t>> groups;
  std::unordered_map<int, std::size_t> group_of_key;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto [group, is_new] = candidates[i].wide()
                                     ? std::make_pair(group_of_key.end(), true)
                                     : group_of_key.emplace(candidates[i].first, groups.size());
    if (is_new) {
      groups.push_back({i});
    } else {
      groups[group->second].push_back(i);
    }
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return groups;
}

// The results of all processes in the order of the candidates. Each process has those of some
// candidates, and none of the others.
std::vector<TestedCandidate> JoinResults(
    const Peers* peers, const std::vector<std::vector<TestedCandidate>>& of_candidate) {
  std::vector<std::pair<std::size_t, TestedCandidate>> results;
  for (std::size_t i = 0; i < of_candidate.size(); ++i) {
    for (const TestedCandidate& tested : of_candidate[i]) results.emplace_back(i, tested);
  }
  results = JoinOverPeers(peers, std::move(results));
  std::stable_sort(results.begin(), results.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<TestedCandidate> all;
  all.reserve(results.size());
  for (const auto& [candidate, tested] : results) all.push_back(tested);
  return all;
}

}  // namespace

std::vector<TestedCandidate> TestLoopCandidates(const ScanSurfaces& surfaces,
                                                const KeyframeGraph& keyframe_graph,
                                                const std::vector<LoopCandidate>& candidates,
                                                ThreadPool* pool) {
  const CandidateTester tester(surfaces, keyframe_graph);
  std::vector<std::vector<TestedCandidate>> of_candidate(candidates.size());
  const std::vector<std::vector<std::size_t>> groups = GroupBySurroundings(candidates);
  const Peers* peers = surfaces.graph().peers();
  const std::vector<std::size_t> own = OwnShare(peers, groups.size());
  pool->ForEach(own.size(), 1, [&](std::size_t i) {
    tester.TestGroup(candidates, groups[own[i]], &of_candidate);
  });
  return JoinResults(peers, of_candidate);
}

std::vector<TestedCandidate> FindPlaces(const ScanSurfaces& surfaces,
                                        const KeyframeGraph& keyframe_graph,
                                        const std::vector<LoopCandidate>& candidates,
                                        int max_places, ThreadPool* pool) {
  const CandidateTester tester(surfaces, keyframe_graph);
  std::vector<std::size_t> first_of_search;  // of the candidates that share one
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i == 0 || !AreSoughtAlike(candidates[i - 1], candidates[i])) first_of_search.push_back(i);
  }
  const Peers* peers = surfaces.graph().peers();
  const std::vector<std::size_t> own = OwnShare(peers, first_of_search.size());
  first_of_search.push_back(candidates.size());
  std::vector<std::vector<TestedCandidate>> of_candidate(candidates.size());
  for (const std::size_t search : own) {
    const std::size_t first = first_of_search[search];
    const CorrelativeMatcher places = tester.PlacesAround(candidates[first]);
    pool->ForEach(first_of_search[search + 1] - first, 1, [&](std::size_t i) {
      of_candidate[first + i] = tester.FindPlaces(places, candidates[first + i], max_places);
    });
  }
  return JoinResults(peers, of_candidate);
}

}  // namespace plumbline
