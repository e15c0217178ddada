#ifndef PLUMBLINE_APPS_BENCHMARK_SOLVER_COMPARISON_H_
#define PLUMBLINE_APPS_BENCHMARK_SOLVER_COMPARISON_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/compared_solvers.h"
#include "plumbline/apps/benchmark/solver_run.h"

namespace plumbline {

struct ComparisonOptions {
  int repeats = 3;              ///< runs of each solver; figures are medians over them
  double time_limit_s = 600.0;  ///< of a run [s], at most a day

  bool Check(std::string* error) const;
};

/// One process after the other, all from the same start. Every solver has its
/// first run before any has its second. `done` is called after each.
std::vector<SolverRun> CompareSolvers(const std::vector<ComparedSolver>& solvers,
                                      const ComparedProblem& problem,
                                      const ComparisonOptions& options,
                                      const std::function<void(const SolverRun&)>& done);

/// The time [s] of the first state within 0.01 % of an energy; none if there is no such state.
std::optional<double> TimeToReach(const SolverRun& run, double energy);

/// What the runs of one solver come to.
struct SolverFigures {
  std::string solver;
  /// Of the runs that came to their end, that with the median duration; null if there are none.
  const SolverRun* median_run = nullptr;
  std::vector<std::string> failures;  ///< of the others
  double final_energy = 0.0;          ///< median, as are
  double time_s = 0.0;
  double peak_memory_bytes = 0.0;
  /// The time [s] to the energy that each of the solvers ends at, in their order; none where half
  /// of the runs do not get there.
  std::vector<std::optional<double>> time_to_reach_s;
  /// Time to its own final energy over that of the first solver to the same energy; none if that
  /// one does not get there.
  std::optional<double> time_ratio;
  std::optional<double> memory_ratio;  ///< of the peaks, to that of the first solver
};

/// Figures per solver, in the order of `solvers`. They point into the runs.
std::vector<SolverFigures> SumUp(const std::vector<ComparedSolver>& solvers,
                                 const std::vector<SolverRun>& runs);

/// The lowest energy on the way of any run; infinity if all failed.
double BestEnergy(const std::vector<SolverRun>& runs);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SOLVER_COMPARISON_H_
