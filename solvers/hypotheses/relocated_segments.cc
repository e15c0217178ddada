#include "plumbline/solvers/hypotheses/relocated_segments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/loop_closure/loop_candidates.h"
#include "plumbline/solvers/loop_closure/loop_closure.h"

namespace plumbline {
namespace {

// Per keyframe that is looked for.
constexpr int kMaxPlaces = 8;
// In all.
constexpr std::size_t kMaxWays = 16;
// The size of a peak of the search (loop_acceptance.h): ways to put two parts together that differ
// by less are the same one, measured at other places.
constexpr double kSameM = LoopAcceptance::kPeakRadiusM;
constexpr double kSameRad = LoopAcceptance::kPeakAngleRad;

// Without what ties keyframes beyond the edge, up to `end`, to others.
std::vector<RelativePoseConstraint> NotAcross(int edge, int end,
                                              const std::vector<RelativePoseConstraint>& closures) {
  const auto is_beyond = [&](int key) { return key > edge && key < end; };
  std::vector<RelativePoseConstraint> others;
  std::copy_if(closures.begin(), closures.end(), std::back_inserter(others),
               [&](const RelativePoseConstraint& closure) {
                 return is_beyond(closure.from) == is_beyond(closure.to);
               });
  return others;
}

KeyframeGraph TakeApart(int edge, KeyframeGraph keys) {
  keys.sequential[edge].in_question = true;
  keys.sequential[edge].broken = true;
  for (auto* closures : {&keys.closures, &keys.contradicted, &keys.refused}) {
    *closures = NotAcross(edge, keys.EndOfSession(edge), *closures);
  }
  return keys;
}

KeyframeGraph Join(int edge, const RelativePoseConstraint& match, const KeyframeGraph& apart) {
  KeyframeGraph joined = apart;
  const Pose2 moved = apart.world_from_key[match.from] * match.from_from_to *
                      apart.world_from_key[match.to].Inverse();
  for (int k = edge + 1; k < joined.EndOfSession(edge); ++k) {
    joined.world_from_key[k] = moved * apart.world_from_key[k];
  }
  joined.closures.push_back(match);
  return joined;
}

}  // namespace

std::vector<KeyframeGraph> RelocateSegment(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                                           int edge, ThreadPool* pool) {
  const KeyframeGraph apart = TakeApart(edge, keys);
  std::vector<TestedCandidate> places =
      FindPlaces(surfaces, apart, FindJoins(apart, edge), kMaxPlaces, pool);
  std::stable_sort(places.begin(), places.end(),
                   [](const TestedCandidate& a, const TestedCandidate& b) {
                     return a.inlier_ratio > b.inlier_ratio;
                   });
  std::vector<KeyframeGraph> joins;
  for (const TestedCandidate& place : places) {
    if (joins.size() == kMaxWays) break;
    KeyframeGraph join = Join(edge, place.edge, apart);
    const bool is_known = std::any_of(joins.begin(), joins.end(), [&](const KeyframeGraph& other) {
      return IsSameRelocation(edge, join, other);
    });
    if (!is_known) joins.push_back(std::move(join));
  }
  return joins;
}

Pose2 StepAt(int edge, const KeyframeGraph& keys) {
  return Between(keys.world_from_key[edge], keys.world_from_key[edge + 1]);
}

bool IsSameRelocation(int edge, const KeyframeGraph& a, const KeyframeGraph& b) {
  const Pose2 apart = Between(StepAt(edge, a), StepAt(edge, b));
  return std::hypot(apart.x, apart.y) < kSameM && std::abs(NormalizeAngle(apart.yaw)) < kSameRad;
}

int ComparedOfLesserPart(const MapConsistency& consistency, int first_pose_after) {
  int before = 0, beyond = 0;
  for (const ViewpointConflict& viewpoint : consistency.viewpoints) {
    (viewpoint.pose < first_pose_after ? before : beyond) += viewpoint.between_passes.num_compared;
  }
  return std::min(before, beyond);
}

}  // namespace plumbline
