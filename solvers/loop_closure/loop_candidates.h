#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CANDIDATES_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CANDIDATES_H_

#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"

namespace plumbline {

/// How little two views have in common [m], if the robot went distance_m and turned by turn_rad in
/// between: a radian counts as a metre.
double ViewDistanceM(double distance_m, double turn_rad);

/// A keyframe that may be a revisit, and where to look for the place.
struct LoopCandidate {
  int first = 0;         ///< keyframe of the earlier visit, the nearest one by what is known so far
  int second = 0;        ///< keyframe of the revisit, later than all of the earlier visit
  double drift_m = 0.0;  ///< how far their relative pose may be off
  double drift_rad = 0.0;
  /// Wide searches only: the keyframes in which the place may have been seen, one per metre or so.
  std::vector<int> surroundings;
  /// Nothing is known of the relative pose: the drift is about the pose of `first` itself.
  bool unknown = false;

  bool wide() const { return !surroundings.empty(); }
};

/// Keyframes that may revisit a place and are not tied to it by a closure of the graph yet, in
/// order of `second`. Processes that share the drive share the work (collective); peers: these, or
/// null.
std::vector<LoopCandidate> FindLoopCandidates(const KeyframeGraph& graph, const Peers* peers,
                                              ThreadPool* pool);

/// Keyframes right after a suspect edge, to be found again in what was seen right before it.
std::vector<LoopCandidate> FindLocalCandidates(const KeyframeGraph& graph);

/// Keyframes spread over what lies between an edge and the next untrusted one, each to be found
/// again anywhere near by, and in any heading, in all that was seen before the edge.
std::vector<LoopCandidate> FindJoins(const KeyframeGraph& graph, int edge);

/// Keyframes spread over the sessions from keyframe `first_of_second` on, each to be found anywhere
/// in what was seen in the sessions before, and in any heading. That is searched square by square:
/// candidates with the same square follow each other.
std::vector<LoopCandidate> FindSessionJoins(const KeyframeGraph& graph, int first_of_second);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_LOOP_CANDIDATES_H_
