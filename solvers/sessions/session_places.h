#ifndef PLUMBLINE_SOLVERS_SESSIONS_SESSION_PLACES_H_
#define PLUMBLINE_SOLVERS_SESSIONS_SESSION_PLACES_H_

#include <map>
#include <utility>
#include <vector>

#include "plumbline/core/measurements.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/loop_closure/loop_closure.h"
#include "plumbline/solvers/sessions/session_set.h"

namespace plumbline {

/// Places of sessions where keyframes of other ones fit, in any heading. The search for them is
/// what takes the time of tying sessions, so every two sessions are searched once, whatever groups
/// they are in later.
class SessionPlaces {
 public:
  /// Refers to both.
  SessionPlaces(const SessionSet& set, ThreadPool* pool) : set_(set), pool_(pool) {}

  /// Between all sessions of a and all of b: edges from keyframes of a to keyframes of b, as
  /// Concatenated(a, b) numbers them. Unavailable if progress stopped it.
  Status Find(const SessionGroup& a, const SessionGroup& b, const SeedingProgress& progress,
              std::vector<TestedCandidate>* places);

 private:
  Status FindBetween(int session, int later_session, const SeedingProgress& progress,
                     const std::vector<TestedCandidate>** places);
  Status Search(const SessionGroup& a, const SessionGroup& b, const SeedingProgress& progress,
                std::vector<TestedCandidate>* places) const;

  const SessionSet& set_;
  ThreadPool* pool_;
  // By two sessions, the lower one first: edges between their keyframes, each session's from 0.
  std::map<std::pair<int, int>, std::vector<TestedCandidate>> known_;
};

/// The same measurement, from the other end.
RelativePoseConstraint Reversed(const RelativePoseConstraint& edge);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SESSIONS_SESSION_PLACES_H_
