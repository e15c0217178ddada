#ifndef PLUMBLINE_SOLVERS_SEEDING_LOOP_CLOSURE_H_
#define PLUMBLINE_SOLVERS_SEEDING_LOOP_CLOSURE_H_

#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/seeding/loop_candidates.h"
#include "plumbline/solvers/seeding/scan_matcher.h"
#include "plumbline/solvers/seeding/sequential_seeding.h"

namespace plumbline {

/// How two visits to a place are matched, and what makes the match a loop closure.
struct LoopClosureOptions {
  LoopCandidateOptions candidates;
  /// What is matched: the key scan with its neighbours up to this much path [m] away, against the
  /// surroundings of the other one up to this much path [m] away.
  double scan_path_m = 0.5;
  double map_path_m = 2.5;
  /// Cell [m] of the correlative search.
  double search_cell_m = 0.1;
  /// Likelihood that a match must reach in the correlative search, in [0, 1].
  double min_search_score = 0.4;
  /// Share of the points on a surface of the map after the fine matching; stricter where the
  /// window is wider than wide_window_m [m] and chance has more room.
  double min_inlier_ratio = 0.55;
  double min_inlier_ratio_wide = 0.65;
  double wide_window_m = 1.0;
  /// Share of the returns that the other visit looked through, at most.
  double max_free_space_conflict = 0.11;
  /// In wide windows: no other place may fit as well as this share of the best one.
  double max_second_peak = 0.9;

  bool Check(std::string* error) const;
};

/// Tests every candidate; the result holds the accepted ones, in order of the candidates, as edges
/// between key scans (from the earlier to the later one).
std::vector<RelativePoseConstraint> CloseLoops(const LoopClosureOptions& options,
                                               const SlamGraph& graph,
                                               const std::vector<SurfacePoints>& surfaces,
                                               const std::vector<KeyScan>& key_scans,
                                               const std::vector<Pose2>& world_from_key,
                                               const std::vector<LoopCandidate>& candidates,
                                               ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_LOOP_CLOSURE_H_
