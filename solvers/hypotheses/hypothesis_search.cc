#include "plumbline/solvers/hypotheses/hypothesis_search.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "plumbline/solvers/hypotheses/broken_steps.h"
#include "plumbline/solvers/hypotheses/given_odometry.h"
#include "plumbline/solvers/hypotheses/kidnapped_robot.h"
#include "plumbline/solvers/hypotheses/odometry_heading_start.h"
#include "plumbline/solvers/hypotheses/posterior.h"
#include "plumbline/solvers/hypotheses/proposer.h"
#include "plumbline/solvers/hypotheses/relocated_segments.h"
#include "plumbline/solvers/hypotheses/revised_closures.h"
#include "plumbline/solvers/hypotheses/steps_in_question.h"
#include "plumbline/solvers/hypotheses/tied_places.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/closure_memory.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"
#include "plumbline/solvers/loop_closure/rematch_at_breaks.h"
#include "plumbline/solvers/loop_closure/rematch_at_leaps.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"

namespace plumbline {
namespace {

// Maximum number of hypotheses whose loops are closed.
constexpr std::size_t kMaxHypotheses = 40;
// A relocation to another place is as good if its energy is higher by at most this share of the
// explicable conflicts of the part that other passes meet less. Tuned on the floors of the seeding
// study (apps/benchmark).
constexpr double kNoContradiction = 1.0 / 3.0;

bool IsRevision(HypothesisKind kind) {
  return kind == HypothesisKind::kWithMatch || kind == HypothesisKind::kWithoutCluster;
}

class HypothesisSearch {
 public:
  HypothesisSearch(const MotionOptions& motion, const ScanSurfaces& surfaces,
                   const SeedingProgress& progress, ThreadPool* pool,
                   const SequentialTrajectory& matched, const KeyframeGraph* ties,
                   std::vector<WeighedHypothesis>* weighed)
      : progress_(progress),
        meter_(surfaces.graph(), matched.world_from_robot, pool),
        posterior_(/*of_one_session=*/ties == nullptr),
        context_{motion,
                 surfaces,
                 pool,
                 std::make_shared<const SequentialTrajectory>(matched),
                 ties != nullptr,
                 meter_,
                 posterior_,
                 ties != nullptr ? *ties : MakeKeyframeGraph(matched, motion)},
        weighed_(*weighed) {
    // In order of promise.
    refinements_.push_back(ProposeWithoutClusters());
    refinements_.push_back(ProposeWithoutRepeatedClusters());
    refinements_.push_back(ProposeTentativeClosures());
    refinements_.push_back(ProposeWithoutBentTies());
    refinements_.push_back(ProposeBrokenSteps());
    refinements_.push_back(ProposeStrainedSteps());
    refinements_.push_back(ProposeRelocations());
  }

  Status Run(MapHypothesis* best) {
    // Given poses may contradict any step as it is.
    if (context_.matched->given_poses.empty()) {
      MarkSuspectEdges(context_.surfaces, context_.matched->world_from_robot, context_.pool,
                       &context_.suspected);
    }
    Proposal matching;
    matching.draft.start = context_.matched;
    matching.draft.keys = context_.suspected;
    PLUMBLINE_RETURN_IF_ERROR(Weigh(std::move(matching)));
    PLUMBLINE_RETURN_IF_ERROR(AddStarts(ProposeGivenOdometry().get()));
    PLUMBLINE_RETURN_IF_ERROR(Refine(best_));
    // A start that drifts may need refinement to become the best.
    const std::size_t num_refined = pool_.size();
    PLUMBLINE_RETURN_IF_ERROR(AddStarts(ProposeOdometryHeadings().get()));
    for (std::size_t i = num_refined, end = pool_.size(); i < end; ++i) {
      PLUMBLINE_RETURN_IF_ERROR(Refine(i));
    }
    *best = std::move(pool_[best_]);
    pool_.erase(pool_.begin() + static_cast<std::ptrdiff_t>(best_));
    CountAlternatives(best);
    for (const std::size_t record : best->records) weighed_[record].adopted = true;
    for (std::size_t i = 0; i < weighed_.size(); ++i) {
      weighed_[i].score = posterior_.Energy(terms_[i]);
    }
    return Status::Ok();
  }

 private:
  // Between the places where loop closing asks by itself.
  Status CheckStop() const {
    if (!progress_ || progress_(SeedingPhase::kClosingLoops, 0, 0)) return Status::Ok();
    return Status::Unavailable("loop closing was stopped by its caller");
  }

  // Weighs the proposals around a hypothesis of the pool, and moves the index to the best of them
  // if that is better. A proposer of alternatives proposes them step by step, and is asked again
  // until it has none.
  Status Explore(Proposer* proposer, std::size_t* around) {
    const std::size_t begin = *around;
    bool has_more = true;
    while (has_more && *around == begin && pool_.size() < kMaxHypotheses) {
      PLUMBLINE_RETURN_IF_ERROR(CheckStop());
      has_more = false;
      for (Proposal& proposal : proposer->Propose(pool_[begin], &context_)) {
        if (pool_.size() >= kMaxHypotheses) break;
        if (!known_.insert(proposal.id).second) continue;
        PLUMBLINE_RETURN_IF_ERROR(CheckStop());
        const std::size_t last = pool_.size();
        PLUMBLINE_RETURN_IF_ERROR(Weigh(std::move(proposal)));
        has_more = proposer->AreAlternatives();
        if (pool_.size() > last && Energy(pool_[last]) < Energy(pool_[*around])) *around = last;
        if (*around != begin && !proposer->AreAlternatives()) break;
      }
    }
    return Status::Ok();
  }

  Status AddStarts(Proposer* proposer) {
    std::size_t best = best_;
    return Explore(proposer, &best);
  }

  // Improves a hypothesis until no refinement makes it better.
  Status Refine(std::size_t hypothesis) {
    if (pool_[hypothesis].keys.size() == 0) return Status::Ok();  // no scan shows a surface
    for (std::size_t next = 0; next < refinements_.size();) {
      const std::size_t before = hypothesis;
      PLUMBLINE_RETURN_IF_ERROR(Explore(refinements_[next].get(), &hypothesis));
      next = hypothesis != before ? 0 : next + 1;
    }
    return Status::Ok();
  }

  // Closes the loops of a proposal, measures its map and adds it to the pool.
  Status Weigh(Proposal proposal) {
    MapHypothesis& hypothesis = proposal.draft;
    const std::size_t record = weighed_.size();
    if (!IsRevision(proposal.record.kind)) {
      proposal.record.kind = hypothesis.kind;
      DropReplaced(hypothesis.assumed.num_added > 0, &hypothesis.records);
    }
    hypothesis.records.insert(hypothesis.records.begin(), record);
    weighed_.push_back(std::move(proposal.record));
    if (proposal.is_promising && !proposal.is_complete) {
      PLUMBLINE_RETURN_IF_ERROR(Close(&hypothesis));
    }
    if (pool_.empty()) posterior_.Begin(hypothesis.consistency);
    if (proposal.is_promising) {
      if (context_.has_sessions) {
        hypothesis.bent_places = BentPlaces(hypothesis.keys, context_.pool);
      }
      hypothesis.terms = Posterior::TermsOf(hypothesis);
    }
    terms_.push_back(hypothesis.terms);
    WeighedHypothesis& weighed = weighed_[record];
    weighed.conflict = hypothesis.consistency.AllConflicts();
    if (!proposal.is_promising) return Status::Ok();
    if (!IsRevision(weighed.kind)) {
      weighed.num_closures = static_cast<int>(hypothesis.keys.closures.size());
      weighed.world_from_robot = hypothesis.world_from_robot;
    }
    if (weighed.kind == HypothesisKind::kJoinedParts) {
      weighed.carried_to = StepAt(hypothesis.relocated_step, hypothesis.keys);
      // Closures found the same place before: not another explanation.
      if (IsWhereClosuresTieIt(hypothesis)) return Status::Ok();
    }
    Insert(std::move(hypothesis));
    return Status::Ok();
  }

  // Whether a hypothesis of the pool ties a relocated segment to the same place by its closures.
  bool IsWhereClosuresTieIt(const MapHypothesis& relocated) const {
    const int step = relocated.relocated_step;
    const int pose = context_.suspected.sequential[step].first_pose_after;
    return std::any_of(pool_.begin(), pool_.end(), [&](const MapHypothesis& other) {
      return other.start == relocated.start && IsTied(pose, other.loops) &&
             IsSameRelocation(step, relocated.keys, other.keys);
    });
  }

  static bool IsTied(int first_pose_after, const LoopClosingReport& loops) {
    const SuspectStep* suspect = FindSuspect(first_pose_after, loops);
    return suspect != nullptr && suspect->num_closures_across >= SuspectStep::kMinClosuresAcross;
  }

  // A new start or other broken steps replace earlier ones. Without added closures, the graph does
  // not have those either.
  void DropReplaced(bool has_added, std::vector<std::size_t>* records) const {
    records->erase(std::remove_if(records->begin(), records->end(),
                                  [&](std::size_t record) {
                                    const HypothesisKind kind = weighed_[record].kind;
                                    return kind != HypothesisKind::kWithoutCluster &&
                                           kind != HypothesisKind::kJoinedParts &&
                                           !(has_added && kind == HypothesisKind::kWithMatch);
                                  }),
                   records->end());
  }

  double Energy(const MapHypothesis& hypothesis) const {
    return posterior_.Energy(hypothesis.terms);
  }

  void Insert(MapHypothesis hypothesis) {
    pool_.push_back(std::move(hypothesis));
    // A better map lowers the usual share, which may make another hypothesis the best.
    for (std::size_t before = pool_.size(); best_ != before;) {
      before = best_;
      for (std::size_t i = 0; i < pool_.size(); ++i) {
        if (Energy(pool_[i]) < Energy(pool_[best_])) best_ = i;
      }
      posterior_.Calibrate(pool_[best_].consistency);
    }
  }

  Status Close(MapHypothesis* hypothesis) {
    PLUMBLINE_RETURN_IF_ERROR(CloseLoops(context_.surfaces, progress_, context_.pool,
                                         &MemoryOf(*hypothesis), &hypothesis->keys,
                                         &hypothesis->loops));
    hypothesis->world_from_robot =
        PosesFollowingKeyframes(hypothesis->keys, hypothesis->start->world_from_robot);
    RematchAtBreaks(context_.surfaces, hypothesis->keys, hypothesis->start->odometry,
                    context_.motion, &hypothesis->world_from_robot);
    RematchAtLeaps(context_.surfaces, hypothesis->keys, hypothesis->start->odometry,
                   context_.motion, context_.pool, &hypothesis->world_from_robot);
    hypothesis->consistency = meter_.Measure(hypothesis->world_from_robot, context_.pool);
    return Status::Ok();
  }

  // The surroundings of keyframes depend on the start, and on which steps are in question.
  ClosureMemory& MemoryOf(const MapHypothesis& hypothesis) {
    std::vector<int> in_question;
    for (const SequentialEdge& edge : hypothesis.keys.sequential) {
      if (edge.in_question || edge.broken) in_question.push_back(edge.constraint.from);
    }
    return memories_[{hypothesis.start, std::move(in_question)}];
  }

  // Counts the other places at which what follows a suspect step would be as likely: other
  // relocations, and, if it was relocated, the place to which closures tie it. They were weighed
  // against the relocation before that was refined.
  void CountAlternatives(MapHypothesis* best) const {
    for (SuspectStep& suspect : best->loops.suspect_steps) {
      const int pose = suspect.first_pose_after;
      const int step = StepBefore(pose);
      if (step < 0) continue;
      const std::size_t relocation = RelocationOf(*best, pose);
      const bool is_relocated = relocation < weighed_.size();
      const double best_energy =
          is_relocated ? posterior_.Energy(terms_[relocation]) : Energy(*best);
      const auto compared = [&](const MapHypothesis& h) {
        return ComparedOfLesserPart(h.consistency, pose);
      };
      std::vector<const MapHypothesis*> places;
      for (const MapHypothesis& place : pool_) {
        const bool is_alternative =
            place.relocated_step == step || (is_relocated && IsTied(pose, place.loops));
        if (!is_alternative || place.start != best->start) continue;
        const double explicable =
            posterior_.explicable_share() * std::max(compared(place), compared(*best));
        if (Energy(place) - best_energy > kNoContradiction * explicable) continue;
        const auto is_same = [&](const MapHypothesis& other) {
          return IsSameRelocation(step, place.keys, other.keys);
        };
        const bool is_known = is_same(*best) || std::any_of(places.begin(), places.end(),
                                                            [&](const MapHypothesis* other) {
                                                              return is_same(*other);
                                                            });
        if (!is_known) places.push_back(&place);
      }
      suspect.num_alternatives = static_cast<int>(places.size());
    }
  }

  // The step in question whose first pose after it is this one; -1 if there is none.
  int StepBefore(int first_pose_after) const {
    const std::vector<SequentialEdge>& edges = context_.suspected.sequential;
    const auto found = std::find_if(edges.begin(), edges.end(), [&](const SequentialEdge& edge) {
      return edge.evidence > 0.0 && edge.first_pose_after == first_pose_after;
    });
    return found == edges.end() ? -1 : static_cast<int>(found - edges.begin());
  }

  // Record of the relocation at a step that is in force; the number of records if there is none.
  std::size_t RelocationOf(const MapHypothesis& hypothesis, int first_pose_after) const {
    for (const std::size_t record : hypothesis.records) {
      if (weighed_[record].kind == HypothesisKind::kJoinedParts &&
          weighed_[record].first_pose_after == first_pose_after) {
        return record;
      }
    }
    return weighed_.size();
  }

  const SeedingProgress& progress_;
  const ConsistencyMeter meter_;
  Posterior posterior_;
  SearchContext context_;
  std::vector<WeighedHypothesis>& weighed_;
  std::vector<EnergyTerms> terms_;  // per weighed hypothesis
  std::vector<std::unique_ptr<Proposer>> refinements_;
  std::set<std::string> known_;  // proposals
  std::map<std::pair<std::shared_ptr<const SequentialTrajectory>, std::vector<int>>, ClosureMemory>
      memories_;
  std::vector<MapHypothesis> pool_;
  std::size_t best_ = 0;  // of the pool
};

}  // namespace

Status SearchMapHypotheses(const MotionOptions& motion, const ScanSurfaces& surfaces,
                           const SeedingProgress& progress, ThreadPool* pool,
                           const SequentialTrajectory& matched, const KeyframeGraph* ties,
                           MapHypothesis* best, std::vector<WeighedHypothesis>* weighed) {
  weighed->clear();
  HypothesisSearch search(motion, surfaces, progress, pool, matched, ties, weighed);
  return search.Run(best);
}

}  // namespace plumbline
