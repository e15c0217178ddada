#ifndef PLUMBLINE_APPS_BENCHMARK_COMPARED_SOLVERS_H_
#define PLUMBLINE_APPS_BENCHMARK_COMPARED_SOLVERS_H_

#include <string>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// A solver with its settings, under the name that tables give it.
struct ComparedSolver {
  std::string name;
  SolverOptions options;
};

/// Limits that let slow minimisers converge. They replace the limits of the base options.
struct ComparisonLimits {
  int line_search_iterations = 300;  ///< CeresOptions::max_num_iterations of a line search
  int cg_sweeps = 100;               ///< AlternatingCgOptions::max_sweeps
};

/// The solvers that are compared by default, as ParseSolvers takes them.
constexpr char kDefaultSolvers[] =
    "reduced,alternating_cg,published,ceres:reduced:iterative_schur:schur_jacobi,"
    "ceres:reduced:sparse_schur,ceres:iterative_schur:schur_jacobi,ceres:sparse_schur";

/// Reads a list of solvers, separated by commas. An entry is SOLVER[:WORD[:WORD...]], SOLVER a name
/// of SolverType. The words of ceres are names of Ceres' own, in any case:
///
/// - linear solvers, preconditioners, trust region strategies and dogleg types, which imply the
///   minimiser trust_region; a dogleg type implies the strategy dogleg;
/// - line search directions, nonlinear conjugate gradient types and line searches, which imply the
///   minimiser line_search; a conjugate gradient type implies its direction;
/// - trust_region and line_search; reduced and points, for CeresOptions::reduced.
///
/// The one other word is reduced:fixed_lines. A word overrides `base`, which
/// counts for all that no word says.
///
/// InvalidArgument names the entry and its fault: an unknown solver or word, words that contradict
/// each other or change nothing, options that SolverOptions::Check refuses, and two entries that
/// run the same.
Status ParseSolvers(const std::string& list, const SolverOptions& base,
                    const ComparisonLimits& limits, std::vector<ComparedSolver>* solvers);

/// The solver and the switches that it goes by, e.g. "ceres reduced iterative_schur schur_jacobi"
/// or "ceres line_search lbfgs wolfe". Two solvers that ParseSolvers makes of one base have the
/// same name if they run the same.
std::string SolverName(const SolverOptions& options);

/// InvalidArgument names one of the `fields` given with --ceres, or --reduced if that is given, if
/// no solver goes by its value, which `base` has.
Status CheckCeresFlagsCount(const std::vector<ComparedSolver>& solvers, const SolverOptions& base,
                            const std::vector<std::string>& fields, bool reduced);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_COMPARED_SOLVERS_H_
