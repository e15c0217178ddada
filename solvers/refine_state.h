#ifndef PLUMBLINE_SOLVERS_REFINE_STATE_H_
#define PLUMBLINE_SOLVERS_REFINE_STATE_H_

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

struct MeasuredSurface;

/// The work of Solve (solve.h) on a state in place, without a copy of its points. On failure
/// (termination kFailure, with the message) *state is unchanged. is_refused: if not null, becomes
/// true where the input is bad.
SolverSummary RefineState(const SolverOptions& options, const SlamGraph& graph, MapState* state,
                          bool* is_refused = nullptr);

/// Like RefineState, with surfaces that have been measured already (LogMapping::surface). Fails on
/// a surface of another number of returns.
SolverSummary RefineState(const SolverOptions& options, const MeasuredSurface& surface,
                          const SlamGraph& graph, MapState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REFINE_STATE_H_
