#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_REVISED_CLOSURES_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_REVISED_CLOSURES_H_

#include <memory>

#include "plumbline/solvers/hypotheses/proposer.h"

namespace plumbline {

/// Proposes the best hypothesis without a cluster of closures that its map contradicts.
std::unique_ptr<Proposer> ProposeWithoutClusters();

/// The same, with all other closures removed that repeat the cluster's.
std::unique_ptr<Proposer> ProposeWithoutRepeatedClusters();

/// Proposes the best hypothesis with a match that was not quite good enough to be a closure.
std::unique_ptr<Proposer> ProposeTentativeClosures();

/// Proposes a map of several sessions without the closures between them at one place, where these
/// bend the sessions by more than noise.
std::unique_ptr<Proposer> ProposeWithoutBentTies();

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_REVISED_CLOSURES_H_
