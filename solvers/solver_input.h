#ifndef PLUMBLINE_SOLVERS_SOLVER_INPUT_H_
#define PLUMBLINE_SOLVERS_SOLVER_INPUT_H_

#include <cmath>
#include <functional>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

class Solver;
struct MeasuredSurface;

/// Whether a coordinate of the state [m or rad] is finite, and near enough for the cells of
/// surfaces to be numbered.
inline bool IsWithinReach(double coordinate) { return std::abs(coordinate) <= 1e8; }

/// Whether a graph can be solved from this state: InvalidArgument names an option out of range or
/// that does not go with the others, what the graph refused (SlamGraph::status), a state of another
/// size than the graph, a pose or point that is not finite or beyond 1e8, a custom factor that
/// does not fit the solver or is not finite, or the lack of any return (of any relative pose, for
/// solvers that look at nothing else). Without needs_points, the state may have none.
Status CheckSolverInput(const SolverOptions& options, const SlamGraph& graph, const MapState& state,
                        bool needs_points = true);

/// InvalidArgument names the first custom factor that sees what the solver does not look at.
Status CheckFactorsFit(const SlamGraph& graph, const Solver& solver);

/// InvalidArgument, with both sizes, if the state is not one of the graph as it has grown. Without
/// needs_points, it may have none.
Status CheckStateSize(const SlamGraph& graph, const MapState& state, bool needs_points = true);

/// InvalidArgument, with both sizes, if the surface is not one of the graph as it has grown.
Status CheckSurfaceSize(const SlamGraph& graph, const MeasuredSurface& surface);

/// What a solver returns that has refused its input.
SolverSummary SolverFailure(const SolverOptions& options, const Status& status);

/// Calls solve, and gives its summary; what it throws becomes a failure.
SolverSummary CatchFailures(const SolverOptions& options,
                            const std::function<SolverSummary()>& solve);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SOLVER_INPUT_H_
