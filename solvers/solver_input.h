#ifndef PLUMBLINE_SOLVERS_SOLVER_INPUT_H_
#define PLUMBLINE_SOLVERS_SOLVER_INPUT_H_

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/solver_options.h"

namespace plumbline {

/// Whether a graph can be solved: InvalidArgument names an option out of range or that does not go
/// with the others, a pose or point that is not finite or beyond 1e8, or the lack of any return
/// (of any relative pose, for solvers that look at nothing else).
Status CheckSolverInput(const SolverOptions& options, const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SOLVER_INPUT_H_
