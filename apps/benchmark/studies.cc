#include "plumbline/apps/benchmark/studies.h"

#include <chrono>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/adversarial.h"
#include "plumbline/apps/benchmark/scaling_study.h"
#include "plumbline/apps/benchmark/seeding_study.h"
#include "plumbline/apps/benchmark/sessions_study.h"
#include "plumbline/apps/benchmark/study_flags.h"
#include "plumbline/apps/benchmark/variations_study.h"
#include "plumbline/apps/program/log_list.h"
#include "plumbline/apps/run/flags.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {
namespace {

// Reads a list of logs and their relations.
Status ReadLogList(const std::string& list, std::vector<KnownLog>* logs) {
  std::vector<std::string> paths;
  PLUMBLINE_RETURN_IF_ERROR(ParseLogList(list, &paths));
  return ReadKnownLogs(paths, logs);
}

int NumBuildings(int by_default) { return FLAGS_buildings > 0 ? FLAGS_buildings : by_default; }

}  // namespace

void PrintText(const std::string& title, const std::string& text, HtmlReport* page) {
  std::cout << text << std::flush;
  page->texts.push_back({title, text});
}

Status StudyScannerFromFlag(StudyScanner* scanner) {
  if (FromString(FLAGS_study_scanner, scanner)) return Status::Ok();
  return Status::InvalidArgument("--study_scanner=" + FLAGS_study_scanner +
                                 ": want fine, short, thinned, fast or people");
}

Status SeedingStudy(const OutputFolder& /*output*/, HtmlReport* page) {
  StudyScanner scanner;
  PLUMBLINE_RETURN_IF_ERROR(StudyScannerFromFlag(&scanner));
  SolverOptions solver;
  SeedingOptions seeding;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&seeding));
  ThreadPool pool(solver.num_threads);
  const auto start = std::chrono::steady_clock::now();
  std::vector<SeedingCase> cases = SeedingCases(NumBuildings(180), FLAGS_study_first_seed);
  for (SeedingCase& run : cases) run.scanner = scanner;
  std::vector<SeedingOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(RunSeedingStudy(cases, seeding, solver.factors, &pool, &outcomes));
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;
  if (!FLAGS_csv.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteSeedingCsv(FLAGS_csv, outcomes));
  PrintText("Seeding study", SeedingTable(outcomes), page);
  std::cout << outcomes.size() << " runs in " << std::fixed << std::setprecision(1)
            << duration.count() << " s on " << pool.num_threads() << " threads\n";
  return Status::Ok();
}

Status SessionsStudy(const OutputFolder& /*output*/, HtmlReport* page) {
  MapLogOptions options;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&options.solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&options.seeding));
  ThreadPool pool(options.solver.num_threads);
  std::vector<SessionsOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(RunSessionsStudy(
      SessionsCases(NumBuildings(24), FLAGS_study_first_seed), options, &pool, &outcomes));
  if (!FLAGS_csv.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteSessionsCsv(FLAGS_csv, outcomes));
  PrintText("Several days in one building", SessionsTable(outcomes), page);
  return Status::Ok();
}

Status VariationsFromFlag(std::vector<const LogVariation*>* variations) {
  const Status status = ParseVariations(FLAGS_variations, variations);
  return status.ok() ? status : Status::InvalidArgument("--variations: " + status.message());
}

std::vector<std::string> FilesOfVariedLogs(const std::string& logs) {
  std::vector<std::string> files = FilesOfLogList(logs), paths;
  if (!ParseLogList(logs, &paths).ok()) return files;
  for (const std::string& path : paths) files.push_back(RelationsBeside(path));
  return files;
}

Status CheckVariedLogs(const std::string& logs) {
  std::vector<KnownLog> ignored;
  return ReadLogList(logs, &ignored);
}

Status StudyVariations(const std::string& log_list, HtmlReport* page) {
  MapLogOptions options;
  std::vector<const LogVariation*> variations;
  std::vector<KnownLog> logs;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&options.solver));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&options.seeding));
  PLUMBLINE_RETURN_IF_ERROR(VariationsFromFlag(&variations));
  PLUMBLINE_RETURN_IF_ERROR(ReadLogList(log_list, &logs));
  ThreadPool pool(options.solver.num_threads);
  std::string rows = VariationHeader();
  std::cout << rows << std::flush;
  std::vector<VariationOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(RunVariationsStudy(
      logs, VariationCases(logs.size(), variations, FLAGS_variation_seeds, FLAGS_study_first_seed),
      options,
      [&](const VariationOutcome& outcome) {
        const std::string row = VariationRow(outcome);
        std::cout << row << std::flush;
        rows += row;
      },
      &pool, &outcomes));
  if (!FLAGS_csv.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteVariationsCsv(FLAGS_csv, outcomes));
  page->texts.push_back({"Runs over variations of logs", rows});
  PrintText("Variations of logs", VariationsTable(outcomes), page);
  return Status::Ok();
}

Status Adversarial(const OutputFolder& /*output*/, HtmlReport* page) {
  SolverOptions solver;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  ThreadPool pool(solver.num_threads);
  std::vector<AdversarialOutcome> outcomes;
  PLUMBLINE_RETURN_IF_ERROR(
      RunAdversarialStudy(AdversarialCases(FLAGS_seeds), solver, &pool, &outcomes));
  if (!FLAGS_csv.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteAdversarialCsv(FLAGS_csv, outcomes));
  PrintText("Never worse?", AdversarialTable(outcomes), page);
  return Status::Ok();
}

Status Scaling(const OutputFolder& /*output*/, HtmlReport* page) {
  std::vector<int> counts;
  PLUMBLINE_RETURN_IF_ERROR(ParseScanCounts(FLAGS_scans, &counts));
  SolverOptions solver;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&solver));
  std::string table = ScalingHeader();
  std::cout << table;
  std::vector<ScalingOutcome> outcomes;
  for (const int count : counts) {
    outcomes.push_back(RunScalingCaseInChild(count, solver));
    const std::string row = ScalingRow(outcomes.back());
    std::cout << row << std::flush;
    table += row;
    // Each time the whole table, so that what has been measured outlives the largest sizes.
    if (!FLAGS_csv.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteScalingCsv(FLAGS_csv, outcomes));
  }
  page->texts.push_back({"Time and memory over size", table});
  return Status::Ok();
}

}  // namespace plumbline
