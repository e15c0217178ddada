#include "plumbline/solvers/solve.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "plumbline/core/float_environment.h"
#include "plumbline/solvers/constraint_start.h"
#include "plumbline/solvers/mirrored_scans.h"
#include "plumbline/solvers/solver.h"
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

// A stretch of surface of half length r, seen with standard deviation s across it, has variances
// r^2 / 3 and s^2: below 4.5 s even a perfect wall fails the default eigenvalue ratio of 0.15.
double SmallestUsefulRadius(const FactorOptions& factors) {
  return 5.0 * std::hypot(factors.beam.sigma_range_m, factors.manifold.sigma_m);
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

ReturnNormalOptions NormalOptionsFor(const RangeBeamOptions& beam) {
  ReturnNormalOptions options;
  options.half_window_m = std::max(0.06, 6.0 * beam.sigma_range_m);
  return options;
}

double FineRadius(const SolverOptions& options) {
  return std::max(options.rounds.fine_radius_m, SmallestUsefulRadius(options.factors));
}

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
