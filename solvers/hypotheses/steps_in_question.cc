#include "plumbline/solvers/hypotheses/steps_in_question.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/solvers/hypotheses/relocated_segments.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {

std::vector<int> MostSuspectSteps(const KeyframeGraph& keys) {
  std::vector<int> steps;
  for (std::size_t e = 0; e < keys.sequential.size(); ++e) {
    if (keys.sequential[e].evidence > 0.0) steps.push_back(static_cast<int>(e));
  }
  std::stable_sort(steps.begin(), steps.end(), [&](int a, int b) {
    return keys.sequential[a].evidence > keys.sequential[b].evidence;
  });
  if (steps.size() > kMaxStepsInQuestion) steps.resize(kMaxStepsInQuestion);
  return steps;
}

const SuspectStep* FindSuspect(int first_pose_after, const LoopClosingReport& loops) {
  const auto found = std::find_if(
      loops.suspect_steps.begin(), loops.suspect_steps.end(),
      [&](const SuspectStep& suspect) { return suspect.first_pose_after == first_pose_after; });
  return found == loops.suspect_steps.end() ? nullptr : &*found;
}

KeyframeGraph WithContradicted(KeyframeGraph keys) {
  keys.closures.insert(keys.closures.end(), keys.contradicted.begin(), keys.contradicted.end());
  keys.contradicted.clear();
  return keys;
}

bool GivesWay(const std::vector<int>& steps, KeyframeGraph keys) {
  keys = WithContradicted(std::move(keys));
  for (const int step : steps) keys.sequential[step].in_question = true;
  OptimizeKeyframes(&keys);
  return std::any_of(steps.begin(), steps.end(), [&](int step) {
    return EdgeChi2(keys.sequential[step].constraint, keys.world_from_key) >
           LoopAcceptance::kMaxEdgeChi2;
  });
}

bool LeadsElsewhere(int step, KeyframeGraph keys) {
  // More than matching leaves, less than a jump that matters.
  constexpr double kElsewhereM = 0.15;
  if (keys.sequential[step].broken) return false;
  keys.sequential[step].broken = true;
  OptimizeKeyframes(&keys);
  const Pose2 off = Between(keys.sequential[step].constraint.from_from_to, StepAt(step, keys));
  return std::hypot(off.x, off.y) > kElsewhereM;
}

}  // namespace plumbline
