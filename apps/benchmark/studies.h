#ifndef PLUMBLINE_APPS_BENCHMARK_STUDIES_H_
#define PLUMBLINE_APPS_BENCHMARK_STUDIES_H_

#include <string>
#include <vector>

#include "plumbline/apps/benchmark/log_variations.h"
#include "plumbline/apps/benchmark/seeding_study.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Prints a text, and adds it to the page.
void PrintText(const std::string& title, const std::string& text, HtmlReport* page);

/// By --study_scanner.
Status StudyScannerFromFlag(StudyScanner* scanner);

/// The variations that --variations names.
Status VariationsFromFlag(std::vector<const LogVariation*>* variations);

/// All files that the study of variations reads for a list of logs (ParseLogList): logs and
/// relations.
std::vector<std::string> FilesOfVariedLogs(const std::string& logs);

/// Reads a list of logs and their relations. Fails like ParseLogList and ReadKnownLogs.
Status CheckVariedLogs(const std::string& logs);

/// Maps variations of a list of logs, by the flags: prints a line per run and two tables, adds them
/// to the page, and writes --csv.
Status StudyVariations(const std::string& logs, HtmlReport* page);

/// The experiments of plumbline_benchmark over many simulated drives, by its flags: each prints a
/// table, adds it to the page, and writes --csv. They write nothing in the output folder.
Status SeedingStudy(const OutputFolder& output, HtmlReport* page);
Status SessionsStudy(const OutputFolder& output, HtmlReport* page);
Status Adversarial(const OutputFolder& output, HtmlReport* page);
Status Scaling(const OutputFolder& output, HtmlReport* page);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_STUDIES_H_
