#include "plumbline/solvers/solve.h"

#include <optional>
#include <utility>

#include "plumbline/core/fixed_poses.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/solvers/acceptance/constraint_start.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/solver_input.h"

namespace plumbline {
namespace {

Status CheckSurface(const MeasuredSurface& surface, const SlamGraph& graph) {
  if (surface.points.size() == graph.num_returns() &&
      surface.normals.size() == graph.num_returns()) {
    return Status::Ok();
  }
  return Status::InvalidArgument("the graph has " + std::to_string(graph.num_returns()) +
                                 " returns, but the surface " +
                                 std::to_string(surface.points.size()) + " points and " +
                                 std::to_string(surface.normals.size()) + " normals");
}

// A null surface has not been measured yet.
SolverSummary SolveOn(const SolverOptions& options, const MeasuredSurface* surface,
                      const SlamGraph& graph, MapState* state) {
  return CatchFailures(options, [&] {
    const Solver& solver = SolverOf(options);
    const bool poses_only = solver.MovesPosesOnly();
    Status status = CheckSolverInput(options, graph, *state);
    if (status.ok() && !IsAtFixedPoses(graph, *state)) {
      MapState placed = *state;
      PutAtFixedPoses(graph, &placed);
      SolverSummary summary = SolveOn(options, surface, graph, &placed);
      if (summary.IsSolutionUsable()) *state = std::move(placed);
      return summary;
    }
    if (status.ok() && surface != nullptr && !poses_only) status = CheckSurface(*surface, graph);
    std::optional<std::vector<double>> suggested;
    if (status.ok() && !poses_only) {
      suggested = StartFromConstraints(graph, state->poses, options.factors.motion);
      status = CheckScansAreNotMirrored(graph, state->poses, suggested);
    }
    if (!status.ok()) return SolverFailure(options, status);
    return solver.Solve({options, graph, surface, suggested}, state);
  });
}

}  // namespace

SolverSummary Solve(const SolverOptions& options, const SlamGraph& graph, MapState* state) {
  const DefaultFloatEnvironment float_environment;
  return SolveOn(options, nullptr, graph, state);
}

SolverSummary Solve(const SolverOptions& options, const MeasuredSurface& surface,
                    const SlamGraph& graph, MapState* state) {
  const DefaultFloatEnvironment float_environment;
  return SolveOn(options, &surface, graph, state);
}

}  // namespace plumbline
