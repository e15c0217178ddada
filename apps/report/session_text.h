#ifndef PLUMBLINE_APPS_REPORT_SESSION_TEXT_H_
#define PLUMBLINE_APPS_REPORT_SESSION_TEXT_H_

#include <string>
#include <vector>

#include "plumbline/apps/evaluation/session_changes.h"
#include "plumbline/apps/report/html_report.h"
#include "plumbline/apps/report/report_json.h"
#include "plumbline/solvers/interface/session_report.h"

namespace plumbline {

/// "a.clf, b.bag". sessions: numbers from 0; names: of all sessions.
std::string JoinedNames(const std::vector<int>& sessions, const std::vector<std::string>& names);

/// What people need to know of how sessions were tied, or why they were not, a line each, indented.
std::string TiesText(const std::vector<SessionTie>& ties, const std::vector<std::string>& names);

/// One object per tie; sessions are numbered from 1.
Json TiesJson(const std::vector<SessionTie>& ties);

/// The changes, the largest first.
ReportTable ChangesTable(const std::vector<SessionMark>& sessions,
                         const std::vector<SessionChange>& changes);

/// One object per change; sessions are numbered from 1.
Json ChangesJson(const std::vector<SessionMark>& sessions,
                 const std::vector<SessionChange>& changes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_REPORT_SESSION_TEXT_H_
