#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_STEPS_IN_QUESTION_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_STEPS_IN_QUESTION_H_

#include <cstddef>
#include <vector>

#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Steps that may be wrong at the same time, at most: it bounds the work.
constexpr std::size_t kMaxStepsInQuestion = 12;

/// The sequential steps with evidence against them, the worst first, at most so many.
std::vector<int> MostSuspectSteps(const KeyframeGraph& keys);

/// The report of the suspect step before a pose, or null.
const SuspectStep* FindSuspect(int first_pose_after, const LoopClosingReport& loops);

/// Gives the closures that the others contradicted another chance.
KeyframeGraph WithContradicted(KeyframeGraph keys);

/// Whether the closures that were found move a step beyond its noise if it is allowed to be wrong:
/// held as firmly as its neighbours, it shares its error out among them, or contradicts closures.
bool GivesWay(const std::vector<int>& steps, KeyframeGraph keys);

/// Whether closures put the far side of a step elsewhere once it does not hold it itself, by more
/// than matching leaves.
bool LeadsElsewhere(int step, KeyframeGraph keys);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_STEPS_IN_QUESTION_H_
