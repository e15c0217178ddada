#ifndef PLUMBLINE_APPS_BENCHMARK_SOLVER_RUN_H_
#define PLUMBLINE_APPS_BENCHMARK_SOLVER_RUN_H_

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/evaluation/map_sharpness.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// A solver with its settings, under the name that tables give it.
struct ComparedSolver {
  std::string name;
  SolverOptions options;
};

/// A state on a solver's way.
struct TracePoint {
  double time_s = 0.0;      ///< since Solve was called
  double cpu_time_s = 0.0;  ///< of all threads together, likewise; tells how busy the machine was
  double marginal_energy = 0.0;
};

/// Mean and standard deviation of the relations metric.
struct RelationsFigures {
  double mean_m = 0.0, std_m = 0.0;
  double mean_deg = 0.0, std_deg = 0.0;
};

/// What one solver made of the seed.
struct SolverRun {
  std::string solver;
  int repeat = 1;
  std::string failure;  ///< why there is nothing else; empty if there is
  std::string termination;
  int num_iterations = 0;
  int num_rounds = 0;
  std::vector<TracePoint> trace;       ///< the seed, the state after each iteration, the result
  std::size_t start_memory_bytes = 0;  ///< resident before the solve, the graph included
  std::size_t peak_memory_bytes = 0;   ///< resident in the solve, at most
  std::optional<RelationsFigures> relations;
  MapSharpness raw_ranges;  ///< of the measured ends of the beams at the final poses
  MapSharpness points;      ///< of the optimised points

  double time_s() const { return trace.back().time_s; }
  double cpu_time_s() const { return trace.back().cpu_time_s; }
  double final_energy() const { return trace.back().marginal_energy; }
};

/// Solves from a seed, with a trace of the way. The clocks stand still while a state is put aside
/// (in a file, as memory is measured) and all evaluation comes after the solve; states are those
/// that the callback is shown.
///
/// After time_limit_s [s] the callback asks the solver to stop. A solver that does not call back
/// for as long again ends the process by SIGALRM. `relations` may be empty.
SolverRun RunSolver(const ComparedSolver& solver, const std::vector<Relation>& relations,
                    double time_limit_s, const SlamGraph& graph, const MapState& seed);

/// The same in a process of its own. A process that
/// comes to a bad end is a failure of the run.
SolverRun RunSolverInChild(const ComparedSolver& solver, const std::vector<Relation>& relations,
                           double time_limit_s, const SlamGraph& graph, const MapState& seed);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SOLVER_RUN_H_
