#ifndef PLUMBLINE_APPS_BENCHMARK_LOG_REPORT_H_
#define PLUMBLINE_APPS_BENCHMARK_LOG_REPORT_H_

#include <string>

#include "plumbline/apps/benchmark/log_experiment.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Tables for people: relations, with what others have published, and sharpness, with times.
std::string LogTables(const LogExperiment& experiment);

/// Writes the relations, one line per stage and class of relations ("all", "local", "revisits"),
/// published figures last. No times, here and below: the same input gives the same bytes.
/// Unavailable if the file cannot be written.
Status WriteLogRelationsCsv(const std::string& path, const LogExperiment& experiment);

/// Writes the sharpness, one line per stage, kind of points and radius.
Status WriteLogSharpnessCsv(const std::string& path, const LogExperiment& experiment);

/// Writes all of it.
Status WriteLogJson(const std::string& path, const LogExperiment& experiment);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_LOG_REPORT_H_
