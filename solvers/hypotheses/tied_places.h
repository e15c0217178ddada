#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_TIED_PLACES_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_TIED_PLACES_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {

/// All closures between one part of a graph and the rest of it at one place, and whether the shape
/// that the drives have without them contradicts them. They may all have one cause: a piece of
/// furniture that was moved since, where walls say nothing, or a building much like this one. Then
/// they agree with each other, however many they are, and only together they can be tested.
struct TiedPlace {
  std::vector<RelativePoseConstraint> closures;
  /// How much lower the squared error of the other edges around the place is without them. If they
  /// are right, chi-squared with three degrees of freedom at most.
  double relief = 0.0;

  /// They bend the graph by more than noise does.
  bool is_bent() const { return relief > LoopAcceptance::kMaxRelief; }
};

/// Tests the closures from keyframes `first` to before `end` to all others, place by place. The
/// graph has to be at its optimum. A place that cannot be relieved by more than least_relief is not
/// tested: its relief is 0.
std::vector<TiedPlace> TestTiedPlaces(const KeyframeGraph& keys, int first, int end,
                                      double least_relief, ThreadPool* pool);

/// The places at which closures bend one session of a graph, of all between one and the others.
std::vector<TiedPlace> BentPlaces(const KeyframeGraph& keys, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_TIED_PLACES_H_
