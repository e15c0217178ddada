#ifndef PLUMBLINE_APPS_BENCHMARK_SOLVER_EXPERIMENT_H_
#define PLUMBLINE_APPS_BENCHMARK_SOLVER_EXPERIMENT_H_

#include <string>

#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Checks --repeats and --time_limit_s. InvalidArgument names the one that is out of range.
Status CheckComparisonNumbers();

/// Checks --solvers, --start and the flags that count for the compared solvers. InvalidArgument
/// names the flag, and the entry of --solvers.
Status CheckComparedSolvers();

/// Runs the solvers that --solvers names on a log, or on a simulated building if the path is empty,
/// prints a table, adds it to the page, and writes solver_comparison.json, .csv and .png.
/// relations: file of true relative poses; may be empty.
Status CompareSolversByFlags(const std::string& log, const std::string& relations,
                             const OutputFolder& output, HtmlReport* page);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SOLVER_EXPERIMENT_H_
