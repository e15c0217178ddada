#ifndef PLUMBLINE_SOLVERS_SEEDING_LOOP_CLOSURE_H_
#define PLUMBLINE_SOLVERS_SEEDING_LOOP_CLOSURE_H_

#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/seeding/key_graph.h"
#include "plumbline/solvers/seeding/loop_candidates.h"
#include "plumbline/solvers/seeding/scan_matcher.h"

namespace plumbline {

/// What became of a pair of places that looked alike.
enum class ClosureVerdict {
  kAccepted,
  kNoMatch,            ///< nothing in the window fits
  kLowOverlap,         ///< too little of the scan lies on surfaces of the map
  kFreeSpaceConflict,  ///< one visit looked through what the other one saw
  kAmbiguous,          ///< another place fits as well
  kContradicted,       ///< the pose graph cannot agree with it
};

const char* ToString(ClosureVerdict verdict);

/// How two visits to a place are matched, and what makes the match a loop closure.
struct LoopClosureOptions {
  LoopCandidateOptions candidates;
  /// What is matched: the key scan with its neighbours up to this much path [m] away, against the
  /// surroundings of the other one up to map_path_m of path [m] away. In wide searches both are of
  /// the latter size: chance has more room there.
  double scan_path_m = 0.5;
  double map_path_m = 5.0;
  /// Cell [m] of the correlative search.
  double search_cell_m = 0.1;
  /// Likelihood that a match must reach in the correlative search, in [0, 1].
  double min_search_score = 0.4;
  /// Share of the points on a surface of the map after the fine matching.
  double min_inlier_ratio = 0.55;
  double min_inlier_ratio_wide = 0.65;
  /// Share of the returns that the other visit looked through, at most.
  double max_free_space_conflict = 0.11;
  /// In wide searches: no other place may fit as well as this share of the best one.
  double max_second_peak = 0.9;

  bool Check(std::string* error) const;
};

/// Matches that show less of the scan than this are not even worth a hypothesis.
constexpr double kTentativeInlierRatio = 0.5;

/// A candidate's verdict and, if something matched, the edge between key scans that it would be
/// (from the earlier to the later one).
struct TestedCandidate {
  ClosureVerdict verdict = ClosureVerdict::kNoMatch;
  RelativePoseConstraint edge;
  double inlier_ratio = 0.0;  ///< share of the scan on surfaces of the other visit
  /// Share of returns that one visit looked through; 0 if too little of the scan matched to ask.
  double conflict = 0.0;
};

/// Tests candidates of the key graph. One result per candidate, in their order.
/// surfaces: per scan of `graph`, in the frame of the robot.
std::vector<TestedCandidate> TestLoopCandidates(const LoopClosureOptions& options,
                                                const SlamGraph& graph,
                                                const std::vector<SurfacePoints>& surfaces,
                                                const KeyGraph& key_graph,
                                                const std::vector<LoopCandidate>& candidates,
                                                ThreadPool* pool);

/// All places where a wide candidate fits, however alike they are: those that show enough of the
/// scan to be worth a hypothesis, max_places per candidate at most, in order of the candidates and
/// from the best fit.
std::vector<TestedCandidate> FindPlaces(const LoopClosureOptions& options, const SlamGraph& graph,
                                        const std::vector<SurfacePoints>& surfaces,
                                        const KeyGraph& key_graph,
                                        const std::vector<LoopCandidate>& candidates,
                                        int max_places, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_LOOP_CLOSURE_H_
