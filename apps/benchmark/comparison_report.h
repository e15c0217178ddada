#ifndef PLUMBLINE_APPS_BENCHMARK_COMPARISON_REPORT_H_
#define PLUMBLINE_APPS_BENCHMARK_COMPARISON_REPORT_H_

#include <string>
#include <vector>

#include "plumbline/apps/benchmark/solver_comparison.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What was compared: the input and all that came of it.
struct Comparison {
  std::string input;  ///< log or building
  std::string start;  ///< where every solver starts, a name of StartType
  int num_scans = 0;
  std::size_t num_returns = 0;
  ComparisonOptions options;
  std::vector<ComparedSolver> solvers;
  std::vector<SolverRun> runs;
};

/// A table for people, one row per solver.
std::string ComparisonTable(const Comparison& comparison);

/// One line per state in the trace of every run that came to its end, from the start (iteration 0)
/// to the result. Unavailable if the file cannot be written; so do the others.
Status WriteComparisonCsv(const std::string& path, const Comparison& comparison);

/// The figures of every solver, and the program's flags.
Status WriteComparisonJson(const std::string& path, const Comparison& comparison);

/// A picture of the first run of each solver: how far above the best energy it is, over time.
Status WriteComparisonPlot(const std::string& path, const Comparison& comparison);

/// Adds the table and the plot to a page to look at in a browser.
void AddComparison(const Comparison& comparison, HtmlReport* page);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_COMPARISON_REPORT_H_
