#include "plumbline/apps/report/run_report.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/report/calibration_report.h"
#include "plumbline/apps/report/report_sections.h"
#include "plumbline/apps/report/seeding_text.h"
#include "plumbline/apps/report/units.h"

namespace plumbline {
namespace {

void AddLoops(const LoopClosingReport& loops, HtmlReport* report) {
  report->figures.push_back({"Loops closed", WithThousands(loops.num_closures),
                             WithThousands(loops.num_candidates) + " places tried"});
  ReportTable table{"Loop closures", {"Outcome", "Matches"}, {}, ""};
  for (const auto& [outcome, count] : CountOutcomes(loops)) {
    std::string name = ToString(outcome);
    std::replace(name.begin(), name.end(), '_', ' ');
    table.rows.push_back({name, WithThousands(count)});
  }
  if (table.rows.empty()) table.rows.push_back({"no place matched another", "0"});
  const auto num_unresolved = std::count_if(loops.suspect_steps.begin(), loops.suspect_steps.end(),
                                            [](const auto& step) { return step.IsUnresolved(); });
  table.note = WithThousands(loops.suspect_steps.size()) + " suspect steps, " +
               WithThousands(num_unresolved) + " of them unresolved.";
  report->tables.push_back(std::move(table));
}

void AddHypotheses(const std::vector<WeighedHypothesis>& hypotheses, HtmlReport* report) {
  if (hypotheses.empty()) return;
  ReportTable table{"Hypotheses about the drive",
                    {"Hypothesis", "Returns compared", "Conflicting", "Score", "Adopted"},
                    {},
                    "Score: negative log posterior in conflicting returns; the lower, the better. "
                    "It counts conflicting and agreeing returns, and costs each slip, relocation "
                    "and revised closure that the hypothesis assumes."};
  for (const WeighedHypothesis& hypothesis : hypotheses) {
    table.rows.push_back({HypothesisText(hypothesis),
                          WithThousands(hypothesis.conflict.num_compared),
                          WithThousands(hypothesis.conflict.num_conflicting),
                          FixedText(hypothesis.score, 0), hypothesis.adopted ? "yes" : "no"});
  }
  report->tables.push_back(std::move(table));
}

}  // namespace

HtmlReport MakeRunReport(const RunSummary& summary) {
  HtmlReport report;
  report.title = std::filesystem::path(summary.log).filename().string();
  report.subtitle = WithThousands(summary.num_scans) + " scans, " +
                    WithThousands(summary.num_returns) + " returns, " +
                    WithThousands(summary.num_skipped_records) + " records skipped";
  AddStop(summary.stopped_by, &report);
  AddAlarms(summary.mapping.alarms, "No sign that the map contradicts itself.", &report);
  AddWarnings(summary.warnings, &report);
  AddStages(summary.stages, &report);
  AddLoops(summary.mapping.seeding.loops, &report);
  AddHypotheses(summary.mapping.seeding.hypotheses, &report);
  AddConsistency(
      {{"Seed", summary.mapping.seeding.consistency}, {"Refined", summary.mapping.consistency}},
      &report);
  report.durations = {{"Reading", summary.read_time_s},
                      {"Seeding: normals, matching, loop closure", summary.seed_time_s}};
  AddSolver(summary.mapping.solver, &report);
  if (!summary.mapping.calibration.parameters.empty()) {
    report.texts.push_back({"Calibration", CalibrationText(summary.mapping.calibration)});
  }
  report.figures.push_back(
      {"Peak memory", FixedText(static_cast<double>(PeakMemoryBytes()) / kBytesPerMb, 0) + " MB",
       "whole run"});
  AddOptionsInForce(&report);
  return report;
}

}  // namespace plumbline
