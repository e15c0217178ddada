#ifndef PLUMBLINE_APPS_BENCHMARK_SOLVER_RUN_H_
#define PLUMBLINE_APPS_BENCHMARK_SOLVER_RUN_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/compared_solvers.h"
#include "plumbline/apps/evaluation/map_sharpness.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measurements.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// What every solver is given.
struct ComparedProblem {
  SlamGraph graph;
  MapState start;  ///< may be without points
  /// Relative poses that solvers of relative poses alone find in the graph beside its own.
  std::vector<RelativePoseConstraint> pose_graph;
  std::vector<Relation> relations;  ///< that the results are measured by; may be empty
};

/// A state on a solver's way.
struct TracePoint {
  int iteration = 0;        ///< 0: the start; the result counts as one more than the last
  double time_s = 0.0;      ///< since Solve was called
  double cpu_time_s = 0.0;  ///< of all threads together, likewise; tells how busy the machine was
  double marginal_energy = 0.0;
};

/// Mean and standard deviation of the relations metric.
struct RelationsFigures {
  double mean_m = 0.0, std_m = 0.0;
  double mean_deg = 0.0, std_deg = 0.0;
};

/// What one solver made of the start.
struct SolverRun {
  std::string solver;
  int repeat = 1;
  std::string failure;  ///< why there is nothing else; empty if there is
  std::string termination;
  int num_iterations = 0;
  int num_rounds = 0;
  /// The start, the states after iterations and the result. A longer trace is thinned to about 200
  /// states, evenly spaced in the logarithm of time.
  std::vector<TracePoint> trace;
  std::size_t start_memory_bytes = 0;  ///< resident before the solve, the graph included
  std::size_t peak_memory_bytes = 0;   ///< resident in the solve, at most
  std::optional<RelationsFigures> relations;
  MapSharpness raw_ranges;  ///< of the measured ends of the beams at the final poses
  MapSharpness points;      ///< of the optimised points

  double time_s() const { return trace.back().time_s; }
  double cpu_time_s() const { return trace.back().cpu_time_s; }
  double final_energy() const { return trace.back().marginal_energy; }
};

/// Solves from the start, with a trace of the way: the states that the solver's callback gets. The
/// clocks stand still while a state is written to a file, and all energies are evaluated after the
/// solve. Energies are of the problem's graph, without its pose graph.
///
/// After time_limit_s [s] the callback asks the solver to stop. A solver that does not call back
/// for as long again ends the process by SIGALRM.
SolverRun RunSolver(const ComparedSolver& solver, const ComparedProblem& problem,
                    double time_limit_s);

/// The same in a process of its own. If that ends early, SolverRun::failure says how.
SolverRun RunSolverInChild(const ComparedSolver& solver, const ComparedProblem& problem,
                           double time_limit_s);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SOLVER_RUN_H_
