#include "plumbline/solvers/refine_state.h"

#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "plumbline/core/fixed_poses.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/core/seconds_since.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/acceptance/constraint_start.h"
#include "plumbline/solvers/acceptance/contradicted_edges.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/round_energies.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/solver_input.h"
#include "plumbline/solvers/terms/align_to_factors.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"

namespace plumbline {
namespace {

// The relative poses that their scans contradict are left out, and may have spoilt the start.
SolverSummary SolveTested(const Solver& solver, const SolverProblem& problem, MapState* state) {
  const auto begin = std::chrono::steady_clock::now();
  const SlamGraph& graph = problem.graph;
  const FactorOptions& factors = problem.options.factors;
  const MeasuredSurface* surface = problem.surface;
  MeasuredSurface own_surface;
  std::vector<ContradictedEdge> contradicted;
  {
    ThreadPool pool(problem.options.num_threads);
    if (surface == nullptr) {
      own_surface = MeasureSurface(graph, NormalOptionsFor(factors.beam), &pool);
      surface = &own_surface;
    }
    contradicted = FindContradictedEdges(graph, *surface, factors.beam, &pool);
  }
  SolverOptions without = problem.options;
  for (const ContradictedEdge& edge : contradicted) {
    without.factors.ignored_relative_poses.push_back(edge.edge);
  }
  const std::optional<std::vector<double>> suggested =
      contradicted.empty()
          ? problem.suggested_poses
          : StartFromConstraints(graph, state->poses, factors.motion, contradicted);
  const double test_time_s = SecondsSince(begin);
  SolverSummary summary = solver.Solve({without, graph, surface, suggested}, state);
  summary.ignored_edges = DescribeIgnored(contradicted, graph, state->poses);
  summary.association_time_s += test_time_s;
  summary.total_time_s += test_time_s;
  return summary;
}

SolverSummary SolveUnmeasured(const Solver& solver, const SolverProblem& problem, MapState* state) {
  const bool has_edges_to_test = problem.options.test_edges && !solver.MovesPosesOnly() &&
                                 !problem.graph.relative_poses().empty();
  return has_edges_to_test ? SolveTested(solver, problem, state) : solver.Solve(problem, state);
}

// With the energies of all rounds.
SolverSummary SolveMeasured(const Solver& solver, const SolverProblem& problem, MapState* state) {
  const SolverOptions& options = problem.options;
  MeasuredSurface own_surface;
  const MeasuredSurface* surface = problem.surface;
  if (surface == nullptr) {
    ThreadPool pool(options.num_threads);
    own_surface = MeasureSurface(problem.graph, NormalOptionsFor(options.factors.beam), &pool);
    surface = &own_surface;
  }
  const RoundEnergyMeter meter(options, problem.graph, *surface, *state);
  SolverSummary summary = SolveUnmeasured(
      solver, {meter.options(), problem.graph, surface, problem.suggested_poses}, state);
  if (summary.IsSolutionUsable()) meter.Measure(*state, &summary);
  return summary;
}

// From a state with points, for solvers that want them, and with its fixed poses in place.
SolverSummary SolvePlaced(const SolverOptions& options, const MeasuredSurface* surface,
                          const SlamGraph& graph, MapState* state, Status* input) {
  const Solver& solver = SolverOf(options);
  const bool poses_only = solver.MovesPosesOnly();
  if (surface != nullptr && (!poses_only || options.measure_rounds)) {
    *input = CheckSurfaceSize(graph, *surface);
  }
  std::optional<std::vector<double>> suggested;
  if (input->ok() && !poses_only) {
    suggested = StartFromConstraints(graph, state->poses, options.factors.motion);
    *input = CheckScansAreNotMirrored(graph, state->poses, suggested);
  }
  if (!input->ok()) return SolverFailure(options, *input);
  const SolverProblem problem{options, graph, surface, suggested};
  const bool has_returns =
      SumOverPeers(graph.peers(), static_cast<double>(graph.num_returns())) > 0.0;
  SolverSummary summary = options.measure_rounds && has_returns
                              ? SolveMeasured(solver, problem, state)
                              : SolveUnmeasured(solver, problem, state);
  // The given state is the result, and had none.
  if (summary.IsSolutionUsable() && state->points.empty()) {
    state->points = graph.MeasuredMap(state->poses);
  }
  return summary;
}

// Fills in points and moves the whole, where that is needed.
SolverSummary PlaceAndSolve(const SolverOptions& options, const MeasuredSurface* surface,
                            const SlamGraph& graph, MapState* state, Status* input) {
  *input = CheckSolverInput(options, graph, *state, false);
  if (!input->ok()) return SolverFailure(options, *input);
  const bool lacks_points =
      state->points.empty() && graph.num_returns() > 0 && !SolverOf(options).IsOverLandmarks();
  const bool is_held_by_factors = graph.fixed_poses().empty();
  if (!lacks_points && !is_held_by_factors && IsAtFixedPoses(graph, *state)) {
    return SolvePlaced(options, surface, graph, state, input);
  }
  MapState placed = *state;
  if (lacks_points) {
    placed.points = graph.MeasuredMap(placed.poses);
    *input = CheckFactors(graph, placed);
    if (!input->ok()) return SolverFailure(options, *input);
  }
  PutAtFixedPoses(graph, &placed);
  AlignToFactors(graph, &placed);
  SolverSummary summary = SolvePlaced(options, surface, graph, &placed, input);
  if (summary.IsSolutionUsable()) *state = std::move(placed);
  return summary;
}

// surface: null if it has yet to be measured. is_refused: becomes true if the input is bad; may be
// null.
SolverSummary SolveOn(const SolverOptions& options, const MeasuredSurface* surface,
                      const SlamGraph& graph, MapState* state, bool* is_refused) {
  return CatchFailures(options, [&] {
    Status input;
    SolverSummary summary = PlaceAndSolve(options, surface, graph, state, &input);
    if (!input.ok() && is_refused != nullptr) *is_refused = true;
    return summary;
  });
}

}  // namespace

SolverSummary RefineState(const SolverOptions& options, const SlamGraph& graph, MapState* state,
                          bool* is_refused) {
  const DefaultFloatEnvironment float_environment;
  return SolveOn(options, nullptr, graph, state, is_refused);
}

SolverSummary RefineState(const SolverOptions& options, const MeasuredSurface& surface,
                          const SlamGraph& graph, MapState* state) {
  const DefaultFloatEnvironment float_environment;
  return SolveOn(options, &surface, graph, state, nullptr);
}

}  // namespace plumbline
