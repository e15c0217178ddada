#include "plumbline/solvers/interface/seeding_report.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

const char* ToString(ClosureOutcome outcome) {
  switch (outcome) {
    case ClosureOutcome::kAccepted:
      return "accepted";
    case ClosureOutcome::kNoMatch:
      return "no_match";
    case ClosureOutcome::kLowOverlap:
      return "low_overlap";
    case ClosureOutcome::kFreeSpaceConflict:
      return "free_space_conflict";
    case ClosureOutcome::kAmbiguous:
      return "ambiguous";
    case ClosureOutcome::kContradicted:
      return "contradicted";
  }
  return "unknown";
}

const char* ToString(HypothesisKind kind) {
  switch (kind) {
    case HypothesisKind::kMatching:
      return "matching";
    case HypothesisKind::kOdometry:
      return "odometry";
    case HypothesisKind::kOdometryAlone:
      return "odometry_alone";
    case HypothesisKind::kOdometryHeadings:
      return "odometry_headings";
    case HypothesisKind::kWithoutCluster:
      return "without_cluster";
    case HypothesisKind::kWithMatch:
      return "with_match";
    case HypothesisKind::kBrokenSteps:
      return "broken_steps";
    case HypothesisKind::kJoinedParts:
      return "joined_parts";
  }
  return "unknown";
}

bool SuspectStep::IsUntied() const {
  const bool is_untrusted = broken || unmatched || evidence >= kUntrustedEvidence;
  return is_untrusted && num_closures_across < kMinClosuresAcross;
}

bool SuspectStep::IsUnresolved() const {
  return num_alternatives > 0 || std::abs(turned_rad) > kMaxCertainTurnRad || IsUntied();
}

bool LoopClosingReport::IsUnresolved() const {
  return std::any_of(suspect_steps.begin(), suspect_steps.end(),
                     [](const SuspectStep& suspect) { return suspect.IsUnresolved(); });
}

bool SeedingReport::Repaired() const {
  return std::any_of(loops.suspect_steps.begin(), loops.suspect_steps.end(),
                     [](const SuspectStep& suspect) { return suspect.broken; });
}

}  // namespace plumbline
