#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_CLOSURE_REVISIONS_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_CLOSURE_REVISIONS_H_

#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Closures that are taken out of a graph, or into it, together.
using Revision = std::vector<RelativePoseConstraint>;

/// The graph with closures that it did not have.
KeyframeGraph With(const Revision& closures, const KeyframeGraph& keys);

/// The graph without some of its closures, which it refuses from now on. What they contradicted
/// gets another chance.
KeyframeGraph Without(const Revision& cluster, const KeyframeGraph& keys);

/// Each cluster with the other closures that say what it says (RepeatsOneOf): where two places look
/// alike for longer than a cluster is, each cluster of them holds the map wrong without the others.
/// Clusters that no other closure repeats are left out.
std::vector<Revision> WithRepetitions(const std::vector<Revision>& clusters,
                                      const KeyframeGraph& keys);

/// The matches that nearly became closures, each by itself.
std::vector<Revision> TentativeMatches(const KeyframeGraph& keys);

/// What is reported of a revision of a graph, but for the map that it makes.
WeighedHypothesis RecordOf(HypothesisKind kind, const Revision& revision,
                           const KeyframeGraph& keys);

/// Moves the keyframes of each graph to its optimum (OptimizeKeyframes). Processes that share the
/// drive share the work; peers: null if there are none.
void OptimizeEach(const Peers* peers, ThreadPool* pool, std::vector<KeyframeGraph>* graphs);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_CLOSURE_REVISIONS_H_
