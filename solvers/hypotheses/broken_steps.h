#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_BROKEN_STEPS_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_BROKEN_STEPS_H_

#include <memory>

#include "plumbline/solvers/hypotheses/proposer.h"

namespace plumbline {

/// Proposes that suspect steps of the sequential matching are wrong: first all steps that closures
/// contradict, then single steps regardless of closures.
std::unique_ptr<Proposer> ProposeBrokenSteps();

/// Proposes that a step is wrong whose error is spread over the steps around it: the segment
/// between two closures is strained, and no single edge is far off.
std::unique_ptr<Proposer> ProposeStrainedSteps();

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_BROKEN_STEPS_H_
