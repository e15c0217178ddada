#ifndef PLUMBLINE_APPS_REPORT_RUN_REPORT_H_
#define PLUMBLINE_APPS_REPORT_RUN_REPORT_H_

#include "plumbline/apps/report/html_report.h"
#include "plumbline/apps/report/run_summary.h"

namespace plumbline {

/// What a run over a log reports to people, with the flags in force: all but its maps and pictures,
/// which the caller adds.
HtmlReport MakeRunReport(const RunSummary& summary);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_RUN_REPORT_H_
