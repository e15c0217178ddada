#ifndef PLUMBLINE_SOLVERS_SESSIONS_SESSION_ALIGNMENT_H_
#define PLUMBLINE_SOLVERS_SESSIONS_SESSION_ALIGNMENT_H_

#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/interface/map_consistency.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/session_report.h"
#include "plumbline/solvers/sessions/session_places.h"
#include "plumbline/solvers/sessions/session_set.h"

namespace plumbline {

/// What scans every metre of the path saw, ready to be compared with those of other sessions.
class SessionViews {
 public:
  explicit SessionViews(const SessionSet& set);

  /// Compares scans of the group's sessions before `first_of_second` (a keyframe where a session
  /// begins) with those from there on, where they stand near to each other.
  FreeSpaceConflict Compare(const SessionGroup& group, int first_of_second, ThreadPool* pool) const;

 private:
  struct View {
    int key;  // of the session
    FreeSpaceScan scan;
  };
  const Peers* peers_;                    // who compare together
  std::vector<std::vector<View>> views_;  // per session
};

/// One way in which two groups of sessions may lie to each other.
struct SessionAlignment {
  SessionGroup group;          ///< both, with loops closed between them
  FreeSpaceConflict conflict;  ///< of scans of the one with scans of the other
  int num_closures = 0;        ///< between the two
  int num_witnesses = 0;       ///< clusters of these closures: one place is one witness
  /// Places of the second group that are tied to the first one, and those that count as bent by it.
  /// Counted for the best alignment, if nothing else speaks against it.
  int num_places = 0, num_bent_places = 0;
  double votes = 0.0;  ///< of the places that were found before loops were closed
  double score = 0.0;  ///< as WeighedHypothesis::score: the lower, the better
};

/// Looks for all ways in which b may lie to a, nothing being known of it: places of the one are
/// sought in all of the other, in any heading; what several of them agree on is a way; loops are
/// closed from there, and the map says how good it is. places: of the set. The best first; none if
/// nothing fits. Unavailable if progress stopped it. The result does not depend on the number of
/// threads.
Status FindAlignments(const SessionSet& set, const SessionViews& views, SessionPlaces* places,
                      const SessionGroup& a, const SessionGroup& b, const SeedingProgress& progress,
                      ThreadPool* pool, std::vector<SessionAlignment>* alignments);

/// What these alignments say, the best of which comes first.
TieOutcome Judge(const std::vector<SessionAlignment>& alignments);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SESSIONS_SESSION_ALIGNMENT_H_
