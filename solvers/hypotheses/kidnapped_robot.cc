#include "plumbline/solvers/hypotheses/kidnapped_robot.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <set>
#include <utility>

#include "plumbline/solvers/hypotheses/relocated_segments.h"
#include "plumbline/solvers/hypotheses/steps_in_question.h"

namespace plumbline {
namespace {

// Maximum number of steps at which the robot may have been kidnapped, and of places per step, the
// best by their maps, around which loops are closed.
constexpr std::size_t kMaxRelocatedSteps = 3;
constexpr std::size_t kMaxLikelyPlaces = 4;

class Relocations : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    if (best.kind != HypothesisKind::kMatching && best.kind != HypothesisKind::kBrokenSteps &&
        best.kind != HypothesisKind::kJoinedParts) {
      return {};
    }
    const bool is_suspicious = context->posterior.IsSuspicious(best.consistency);
    for (const int step : MostSuspectSteps(context->suspected)) {
      const SequentialEdge& edge = context->suspected.sequential[step];
      const bool is_suspect = edge.evidence >= SuspectStep::kUntrustedEvidence && is_suspicious;
      if (!is_suspect && !IsUnsettled(step, best, *context)) continue;
      if (tried_.size() == kMaxRelocatedSteps) break;
      if (!tried_.insert(step).second) continue;
      std::vector<Proposal> places = ProposeAt(step, best, *context);
      if (!places.empty()) return places;
    }
    return {};
  }

  bool AreAlternatives() const override { return true; }

 private:
  // The hypothesis leaves it open where the step leads.
  static bool IsUnsettled(int step, const MapHypothesis& best, const SearchContext& context) {
    if (best.keys.sequential[step].broken) return true;
    const SuspectStep* suspect =
        FindSuspect(context.suspected.sequential[step].first_pose_after, best.loops);
    return suspect != nullptr && suspect->IsUnresolved();
  }

  static std::vector<Proposal> ProposeAt(int step, const MapHypothesis& best,
                                         const SearchContext& context) {
    std::vector<KeyframeGraph> all =
        RelocateSegment(context.surfaces, best.keys, step, context.pool);
    std::vector<double> energy;
    for (const MapConsistency& map : context.Measure(all, *best.start)) {
      energy.push_back(context.posterior.ScanEnergy(map.AllConflicts()));
    }
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return energy[a] < energy[b]; });
    if (order.size() > kMaxLikelyPlaces) order.resize(kMaxLikelyPlaces);
    std::vector<Proposal> proposals;
    for (const std::size_t i : order) {
      Proposal place;
      place.id = "relocated at " + std::to_string(step) + " to " + std::to_string(i);
      place.draft.kind = HypothesisKind::kJoinedParts;
      place.draft.start = best.start;
      place.draft.keys = std::move(all[i]);
      place.draft.assumed = best.assumed;
      place.draft.relocated_step = step;
      place.draft.records = best.records;
      place.record.first_pose_after = context.suspected.sequential[step].first_pose_after;
      proposals.push_back(std::move(place));
    }
    return proposals;
  }

  std::set<int> tried_;
};

}  // namespace

std::unique_ptr<Proposer> ProposeRelocations() { return std::make_unique<Relocations>(); }

}  // namespace plumbline
