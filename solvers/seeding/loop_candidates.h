#ifndef PLUMBLINE_SOLVERS_SEEDING_LOOP_CANDIDATES_H_
#define PLUMBLINE_SOLVERS_SEEDING_LOOP_CANDIDATES_H_

#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/seeding/key_graph.h"

namespace plumbline {

/// Which pairs of key scans may show the same place.
struct LoopCandidateOptions {
  /// How far the relative pose of two key scans may be off after a way of w [m] between them, the
  /// shortest over sequential edges and closures found so far:
  ///   floor + drift_per_path * w + drift_per_path_squared * w^2, at most max_drift_m [m].
  /// The linear part is slip and scale, the quadratic one a heading that turns steadily.
  double drift_floor_m = 0.4;
  double drift_per_path = 0.025;
  double drift_per_path_squared_1_m = 1e-4;
  double max_drift_m = 50.0;
  /// The same for their relative heading [rad], [rad per m].
  double drift_floor_rad = 0.15;
  double drift_rad_per_m = 0.001;
  /// How far an untrusted edge may be off on top of that [m], [rad]. Half a turn is left out: many
  /// rooms and corridors look alike from behind.
  double doubt_drift_m = 7.0;
  double doubt_drift_rad = 1.75;
  /// Such an edge is bridged by matching what lies up to this much path [m] beyond it with what
  /// lies before it, turned by no more than this [rad]: wheels slip farther than they turn.
  double bridge_path_m = 4.0;
  double bridge_turn_rad = 0.5;
  /// Key scans this near to each other [m] see enough of the same surfaces.
  double reach_m = 2.0;
  /// A revisit begins after this much path [m]: what is nearer is tied by the sequential matching.
  double min_path_m = 6.0;
  /// Closures are looked for from one key scan per this stretch of path [m], ...
  double spacing_m = 0.5;
  /// ... with at most this many earlier visits to the place, the nearest ones.
  int max_visits = 4;
  /// Beyond this drift [m] the search is wide: it covers all that was seen earlier within the
  /// drift, once per wide_spacing_m of path [m] or this share of the drift, whichever is more. One
  /// success brings its neighbours into reach.
  double wide_drift_m = 1.0;
  double wide_spacing_m = 3.0;
  double wide_spacing_per_drift = 0.25;

  bool Check(std::string* error) const;
};

/// How little two views have in common [m], if the robot went distance_m and turned by turn_rad in
/// between: a radian counts as a metre.
double ViewDistanceM(double distance_m, double turn_rad);

/// A key scan that may be a revisit, and where to look for the place.
struct LoopCandidate {
  int first = 0;         ///< key scan of the earlier visit, the nearest one by what is known so far
  int second = 0;        ///< key scan of the revisit, later than all of the earlier visit
  double drift_m = 0.0;  ///< how far their relative pose may be off
  double drift_rad = 0.0;
  /// Wide searches only: the key scans in which the place may have been seen, one per metre or so.
  std::vector<int> surroundings;

  bool wide() const { return !surroundings.empty(); }
};

/// Key scans that may revisit a place and are not tied to it by a closure of the graph yet, in
/// order of `second`.
std::vector<LoopCandidate> FindLoopCandidates(const LoopCandidateOptions& options,
                                              const KeyGraph& graph, ThreadPool* pool);

/// Key scans right after a doubtful edge, to be found again in what was seen right before it.
std::vector<LoopCandidate> FindBridges(const LoopCandidateOptions& options, const KeyGraph& graph);

/// Key scans spread over what lies between an edge and the next untrusted one, each to be found
/// again anywhere near by, and in any heading, in all that was seen before the edge.
std::vector<LoopCandidate> FindJoins(const LoopCandidateOptions& options, const KeyGraph& graph,
                                     int edge);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_LOOP_CANDIDATES_H_
