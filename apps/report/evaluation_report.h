#ifndef PLUMBLINE_APPS_REPORT_EVALUATION_REPORT_H_
#define PLUMBLINE_APPS_REPORT_EVALUATION_REPORT_H_

#include <string>

#include "plumbline/apps/evaluation/evaluation.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Tables for people.
std::string EvaluationTables(const Evaluation& evaluation);

/// Writes the figures as nested JSON objects, e.g. relations.revisits.translation_m.mean; figures
/// of an empty set are null. Unavailable if the file cannot be written.
Status WriteEvaluationJson(const std::string& path, const Evaluation& evaluation);

/// Writes the same figures as lines `figure,value`, e.g. relations/revisits/translation_m/mean;
/// values of an empty set are empty.
Status WriteEvaluationCsv(const std::string& path, const Evaluation& evaluation);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_EVALUATION_REPORT_H_
