#ifndef PLUMBLINE_SOLVERS_SESSIONS_ALIGN_SESSIONS_H_
#define PLUMBLINE_SOLVERS_SESSIONS_ALIGN_SESSIONS_H_

#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/session_report.h"
#include "plumbline/solvers/sessions/session_set.h"

namespace plumbline {

/// Ties the sessions of a set that show the same place, nothing being known of how they lie to each
/// other. The two whose alignment is the best are tied first, and then treated as one: sessions
/// that have nothing in common may each have something in common with a third.
///
/// groups: each session is in one of them; in order of their first sessions. Unavailable if
/// progress stopped it. The result does not depend on the number of threads.
Status AlignSessions(const SessionSet& set, const SeedingProgress& progress, ThreadPool* pool,
                     std::vector<SessionGroup>* groups, std::vector<SessionTie>* ties);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SESSIONS_ALIGN_SESSIONS_H_
