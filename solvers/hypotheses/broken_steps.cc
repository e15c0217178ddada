#include "plumbline/solvers/hypotheses/broken_steps.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/solvers/hypotheses/steps_in_question.h"
#include "plumbline/solvers/hypotheses/strained_stretches.h"
#include "plumbline/solvers/loop_closure/closure_clusters.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"

namespace plumbline {
namespace {

// Maximum number of single steps that are proposed around one hypothesis.
constexpr int kMaxSingleSteps = 3;

bool KeepsTheMatching(const MapHypothesis& hypothesis) {
  if (!hypothesis.start->given_poses.empty()) return false;  // which may contradict any step
  return hypothesis.kind == HypothesisKind::kMatching ||
         hypothesis.kind == HypothesisKind::kBrokenSteps;
}

std::string IdOf(const KeyframeGraph& keys) {
  std::string id = "broken";
  for (std::size_t e = 0; e < keys.sequential.size(); ++e) {
    const SequentialEdge& edge = keys.sequential[e];
    if (edge.broken || edge.in_question) id += (edge.broken ? " " : " ?") + std::to_string(e);
  }
  return id + " with" + IdOf(keys.closures) + " without" + IdOf(keys.refused);
}

Proposal MakeProposal(KeyframeGraph keys, const MapHypothesis& best, const SearchContext& context) {
  Proposal broken;
  broken.id = IdOf(keys);
  broken.draft.kind = HypothesisKind::kBrokenSteps;
  broken.draft.start = context.matched;
  broken.draft.keys = std::move(keys);
  broken.draft.assumed.num_removed = best.assumed.num_removed;
  broken.draft.records = best.records;
  return broken;
}

// Marks the step near a pose whose sides agree worst, however little evidence that is: a robot that
// was kidnapped from one of many similar places to another sees little that conflicts.
void MarkStepAt(int pose, SearchContext* context) {
  constexpr int kNearKeys = 8;
  KeyframeGraph& suspected = context->suspected;
  const auto key = std::find_if(suspected.keyframes.begin(), suspected.keyframes.end(),
                                [pose](const Keyframe& keyframe) { return keyframe.pose >= pose; });
  const int at = static_cast<int>(key - suspected.keyframes.begin());
  const int first = std::max(0, at - kNearKeys);
  const int end = std::min(at + kNearKeys, suspected.size() - 1);
  if (first >= end) return;
  KeyframeGraph marked = suspected;
  const int step =
      MarkWorstEdge(context->surfaces, context->matched->world_from_robot, first, end, &marked);
  SequentialEdge& edge = suspected.sequential[step];
  if (edge.evidence > 0.0) return;
  edge = marked.sequential[step];
  // The score is not scaled to the drive, so it must not make the step untrusted.
  edge.evidence = std::min(edge.evidence, 0.9 * SuspectStep::kUntrustedEvidence);
}

// The graph of the matching, with the suspect steps in question.
KeyframeGraph InQuestion(const std::vector<int>& suspects, const MapHypothesis& best,
                         const SearchContext& context) {
  KeyframeGraph keys = context.suspected;
  keys.refused = best.keys.refused;
  // Closures between sessions are there from the start.
  keys.closures.erase(std::remove_if(keys.closures.begin(), keys.closures.end(),
                                     [&](const RelativePoseConstraint& closure) {
                                       return RepeatsOneOf(closure, keys.refused, keys);
                                     }),
                      keys.closures.end());
  for (const int step : suspects) keys.sequential[step].in_question = true;
  return keys;
}

class BrokenSteps : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    if (!KeepsTheMatching(best)) return {};
    const Posterior& posterior = context->posterior;
    if (posterior.PassesDisagree(best.consistency)) {
      MarkStepAt(best.consistency.worst_within.pose, context);
    }
    const std::vector<int> suspects = MostSuspectSteps(context->suspected);
    const bool is_suspicious = posterior.IsSuspicious(best.consistency);
    if (suspects.empty() ||
        !(is_suspicious || best.loops.IsUnresolved() || GivesWay(suspects, best.keys))) {
      return {};
    }
    const KeyframeGraph in_question = InQuestion(suspects, best, *context);
    std::vector<Proposal> proposals{MakeProposal(in_question, best, *context)};
    if (!is_suspicious) return proposals;
    for (int i = 0; i < std::min(kMaxSingleSteps, static_cast<int>(suspects.size())); ++i) {
      KeyframeGraph forced = in_question;
      forced.sequential[suspects[i]].broken = true;
      proposals.push_back(MakeProposal(std::move(forced), best, *context));
    }
    return proposals;
  }
};

class StrainedSteps : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    if (!KeepsTheMatching(best)) return {};
    KeyframeGraph marked = InQuestion(MostSuspectSteps(context->suspected), best, *context);
    std::vector<int> steps = MostStrainedSteps(
        context->surfaces, context->matched->world_from_robot, best.keys, &marked);
    std::stable_sort(steps.begin(), steps.end(), [&](int a, int b) {
      return marked.sequential[a].evidence > marked.sequential[b].evidence;
    });
    if (steps.size() > kMaxStepsInQuestion) steps.resize(kMaxStepsInQuestion);
    std::vector<Proposal> proposals;
    for (const int step : steps) {
      if (static_cast<int>(proposals.size()) == kMaxSingleSteps) break;
      if (!LeadsElsewhere(step, best.keys)) continue;
      KeyframeGraph forced = WithContradicted(best.keys);
      forced.sequential[step] = marked.sequential[step];
      forced.sequential[step].in_question = forced.sequential[step].broken = true;
      proposals.push_back(MakeProposal(std::move(forced), best, *context));
      proposals.back().draft.assumed = best.assumed;
      ++proposals.back().draft.assumed.num_strained;
    }
    return proposals;
  }
};

}  // namespace

std::unique_ptr<Proposer> ProposeBrokenSteps() { return std::make_unique<BrokenSteps>(); }

std::unique_ptr<Proposer> ProposeStrainedSteps() { return std::make_unique<StrainedSteps>(); }

}  // namespace plumbline
