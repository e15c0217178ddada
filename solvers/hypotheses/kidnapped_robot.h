#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_KIDNAPPED_ROBOT_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_KIDNAPPED_ROBOT_H_

#include <memory>

#include "plumbline/solvers/hypotheses/proposer.h"

namespace plumbline {

/// Proposes, for one suspect step after the other, that the robot was kidnapped there, and the
/// places of the map where it may have been put (RelocateSegment).
std::unique_ptr<Proposer> ProposeRelocations();

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_KIDNAPPED_ROBOT_H_
