#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CANDIDATES_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CANDIDATES_H_

#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"

namespace plumbline {

/// Difference of two views [m]: distance, and a metre per radian of turn.
double ViewDistanceM(double distance_m, double turn_rad);

/// A keyframe that may revisit a place, and where to look for the place.
struct LoopCandidate {
  int first = 0;         ///< keyframe of the earlier visit, the nearest one by what is known so far
  int second = 0;        ///< keyframe of the revisit, later than all of the earlier visit
  double drift_m = 0.0;  ///< how far their relative pose may be off
  double drift_rad = 0.0;
  /// Wide searches only: the keyframes in which the place may have been seen, one per metre or so.
  std::vector<int> surroundings;
  /// The relative pose is unknown: the drift is about the pose of `first` itself.
  bool unknown = false;

  bool wide() const { return !surroundings.empty(); }
};

/// Keyframes that may revisit a place and are not tied to it by a closure of the graph yet, in
/// order of `second`. Processes that share the drive share the work (collective); peers: these, or
/// null. first_key: earlier keyframes are no revisits.
std::vector<LoopCandidate> FindLoopCandidates(const KeyframeGraph& graph, const Peers* peers,
                                              ThreadPool* pool, int first_key = 0);

/// Keyframes spread over the path from an edge to the next untrusted one, each to be found again
/// near by, in any heading, in the scans before the edge.
std::vector<LoopCandidate> FindJoins(const KeyframeGraph& graph, int edge);

/// Keyframes spread over the sessions from keyframe `first_of_second` on, each to be found
/// anywhere, in any heading, in the sessions before. These are searched square by square:
/// candidates with the same square follow each other.
std::vector<LoopCandidate> FindSessionJoins(const KeyframeGraph& graph, int first_of_second);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CANDIDATES_H_
