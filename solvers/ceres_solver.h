#ifndef PLUMBLINE_SOLVERS_CERES_SOLVER_H_
#define PLUMBLINE_SOLVERS_CERES_SOLVER_H_

#include <string>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/inner_solve.h"
#include "plumbline/solvers/solver_options.h"

namespace plumbline {

/// Fails on a combination of switches that the installed Ceres refuses, with its own words, or that
/// would abort in it.
Status CheckCeresOptions(const CeresOptions& options);

/// Minimises the joint energy over all poses and points with Ceres. The graph holds the best state
/// on return.
InnerResult SolveWithCeres(const Associations& associations, const FactorOptions& factors,
                           const CeresOptions& options, int num_threads,
                           const ProgressCallback& report, SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_CERES_SOLVER_H_
