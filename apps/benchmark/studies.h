#ifndef PLUMBLINE_APPS_BENCHMARK_STUDIES_H_
#define PLUMBLINE_APPS_BENCHMARK_STUDIES_H_

#include <string>

#include "plumbline/apps/benchmark/seeding_study.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Prints a text, and adds it to the page.
void PrintText(const std::string& title, const std::string& text, HtmlReport* page);

/// By --study_scanner.
Status StudyScannerFromFlag(StudyScanner* scanner);

/// The experiments of plumbline_benchmark over many simulated drives, by its flags: each prints a
/// table, adds it to the page, and writes --csv. They write nothing in the output folder.
Status SeedingStudy(const OutputFolder& output, HtmlReport* page);
Status SessionsStudy(const OutputFolder& output, HtmlReport* page);
Status Adversarial(const OutputFolder& output, HtmlReport* page);
Status Scaling(const OutputFolder& output, HtmlReport* page);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_STUDIES_H_
