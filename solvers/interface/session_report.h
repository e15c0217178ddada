#ifndef PLUMBLINE_SOLVERS_INTERFACE_SESSION_REPORT_H_
#define PLUMBLINE_SOLVERS_INTERFACE_SESSION_REPORT_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// Whether two groups of sessions show the same place.
enum class TieOutcome {
  kTied,          ///< they do, and this is how they lie to each other
  kNoMatch,       ///< nothing of the one fits anywhere in the other
  kFewPlaces,     ///< too few places match to believe them
  kContradicted,  ///< places match, but the one looked through what the other one saw
  kBent,          ///< places match, but only if the sessions are bent at most of them
  kAmbiguous,     ///< several ways to put them together fit as well
};

const char* ToString(TieOutcome outcome);

/// What the comparison of two groups of sessions came to: all that were tied, in that order, then
/// what was left apart.
struct SessionTie {
  std::vector<int> first;                     ///< sessions of the one, in ascending order
  std::vector<int> second;                    ///< of the other one
  TieOutcome outcome = TieOutcome::kNoMatch;  ///< what follows from the rest
  /// Of the best way to put them together, if there is one: the frame of the second group's first
  /// session, by its own seed, as seen from the first group's.
  Pose2 first_from_second;
  int num_closures = 0;   ///< loop closures between the two
  int num_witnesses = 0;  ///< clusters of them: one place is one witness
  /// Places of the second group that closures tie to the first one. Counted where nothing else
  /// speaks against the tie.
  int num_places = 0;
  int num_bent_places = 0;  ///< those of them that bend the groups more than right ones do
  /// Of scans of the one with scans of the other.
  FreeSpaceConflict conflict;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_SESSION_REPORT_H_
