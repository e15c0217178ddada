#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_ODOMETRY_HEADING_START_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_ODOMETRY_HEADING_START_H_

#include <memory>

#include "plumbline/solvers/hypotheses/proposer.h"

namespace plumbline {

/// Proposes the matching with the headings of the odometry over long distances
/// (WithOdometryHeadings). A matching whose heading drifts misses loops, and few scans conflict.
std::unique_ptr<Proposer> ProposeOdometryHeadings();

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_ODOMETRY_HEADING_START_H_
