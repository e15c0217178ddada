#ifndef PLUMBLINE_APPS_REPORT_REPORT_SECTIONS_H_
#define PLUMBLINE_APPS_REPORT_REPORT_SECTIONS_H_

#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/warning.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

// What the reports of different programs have in common. Each adds its part to the report.

/// The alarms, or else `all_clear`.
void AddAlarms(const std::vector<Alarm>& alarms, const std::string& all_clear, HtmlReport* report);

/// The warnings about inputs and results.
void AddWarnings(const std::vector<Warning>& warnings, HtmlReport* report);

/// Says that a signal of this name has ended the estimation early; nothing if it is empty.
void AddStop(const std::string& signal_name, HtmlReport* report);

/// Figures of the last stage next to those of the first, and a table of all.
void AddStages(const std::vector<Stage>& stages, HtmlReport* report);

/// Terms, energy over time, how far points moved, time by phase.
void AddSolver(const SolverSummary& solver, HtmlReport* report);

/// How maps, by name, agree with themselves.
void AddConsistency(const std::vector<std::pair<std::string, MapConsistency>>& maps,
                    HtmlReport* report);

/// The program's flags.
void AddOptionsInForce(HtmlReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_REPORT_SECTIONS_H_
