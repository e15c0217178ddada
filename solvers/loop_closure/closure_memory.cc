#include "plumbline/solvers/loop_closure/closure_memory.h"

#include <cmath>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// Tuned on mit-killian, infinite-corridor, acapulco and fr-clinic, where a new search is worth its
// time.

// A window may reach this much beyond the one that was searched [m], [rad], plus a share of its
// width: windows are estimates, and a match at their very edge is rare.
constexpr double kSlackM = 0.25;
constexpr double kSlackRad = 0.05;
constexpr double kSlackShare = 0.1;
// Smallest window, as a share of the one before, that is still the same search: a search that found
// nothing in a wide window, or two places, may succeed in a part of it.
constexpr double kSameSearchShare = 0.5;
// Path [m] between keyframes that see the same place.
constexpr double kSamePlaceM = 0.5;

}  // namespace

ClosureMemory::Entry ClosureMemory::EntryOf(const LoopCandidate& candidate, int first,
                                            const KeyframeGraph& keys) {
  Entry entry;
  entry.first = first;
  entry.drift_m = candidate.drift_m;
  entry.drift_rad = candidate.drift_rad;
  entry.first_from_second =
      Between(keys.world_from_key[first], keys.world_from_key[candidate.second]);
  entry.num_surroundings = static_cast<int>(candidate.surroundings.size());
  for (const int k : candidate.surroundings) {
    entry.surroundings_center +=
        Between(keys.world_from_key[first], keys.world_from_key[k]).translation() /
        entry.num_surroundings;
  }
  return entry;
}

bool ClosureMemory::Covers(const Entry& before, const LoopCandidate& candidate,
                           const KeyframeGraph& keys) {
  if (candidate.wide() != (before.num_surroundings > 0)) return false;
  const double path_m =
      std::abs(keys.keyframes[before.first].path_m - keys.keyframes[candidate.first].path_m);
  if (!candidate.wide() && path_m > kSamePlaceM) return false;
  const Entry now = EntryOf(candidate, before.first, keys);
  const double slack_m = kSlackM + kSlackShare * before.drift_m;
  const double slack_rad = kSlackRad + kSlackShare * before.drift_rad;
  const Pose2 moved = Between(before.first_from_second, now.first_from_second);
  if (moved.translation().norm() + now.drift_m > before.drift_m + slack_m) return false;
  if (std::abs(NormalizeAngle(moved.yaw)) + now.drift_rad > before.drift_rad + slack_rad) {
    return false;
  }
  if (candidate.wide()) {
    // As much as before was seen, in the same direction. What is left out can only be less.
    if (now.num_surroundings > (1.0 + kSlackShare) * before.num_surroundings) return false;
    if (before.tested.outcome != ClosureOutcome::kAccepted &&
        now.drift_m < kSameSearchShare * before.drift_m) {
      return false;
    }
    if ((now.surroundings_center - before.surroundings_center).norm() > slack_m) return false;
  }
  if (before.tested.outcome == ClosureOutcome::kNoMatch) return true;
  const RelativePoseConstraint& edge = before.tested.edge;
  const Pose2 off =
      Between(keys.world_from_key[edge.to], keys.world_from_key[edge.from] * edge.from_from_to);
  return off.translation().norm() <= now.drift_m + slack_m &&
         std::abs(off.yaw) <= now.drift_rad + slack_rad;
}

const TestedCandidate* ClosureMemory::Find(const LoopCandidate& candidate,
                                           const KeyframeGraph& keys) const {
  const auto entries = of_second_.find(candidate.second);
  if (entries == of_second_.end()) return nullptr;
  // The newest first: its window is the most like this one.
  for (auto entry = entries->second.rbegin(); entry != entries->second.rend(); ++entry) {
    if (Covers(*entry, candidate, keys)) return &entry->tested;
  }
  return nullptr;
}

void ClosureMemory::Add(const LoopCandidate& candidate, const KeyframeGraph& keys,
                        const TestedCandidate& tested) {
  Entry entry = EntryOf(candidate, candidate.first, keys);
  entry.tested = tested;
  of_second_[candidate.second].push_back(entry);
}

}  // namespace plumbline
