#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_GIVEN_ODOMETRY_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_GIVEN_ODOMETRY_H_

#include <memory>

#include "plumbline/solvers/hypotheses/proposer.h"

namespace plumbline {

/// Proposes the poses of the odometry as they were given, and, if the best map contradicts itself
/// and theirs hardly does, with loops closed around them.
std::unique_ptr<Proposer> ProposeGivenOdometry();

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_GIVEN_ODOMETRY_H_
