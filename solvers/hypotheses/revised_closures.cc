#include "plumbline/solvers/hypotheses/revised_closures.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/hypotheses/closure_revisions.h"
#include "plumbline/solvers/hypotheses/suspect_clusters.h"
#include "plumbline/solvers/hypotheses/tied_places.h"

namespace plumbline {
namespace {

// Maximum number of accepted revisions of one kind.
constexpr int kMaxRevisions = 6;
constexpr int kMaxBentPlaces = 12;
// Clusters are measured this many at a time, until one of them gains this many units.
constexpr std::size_t kClustersAtATime = 4;
constexpr double kPromisingGain = 0.5;

std::string IdOf(HypothesisKind kind, const Revision& revision, const MapHypothesis& best) {
  std::string id = ToString(kind);
  for (const RelativePoseConstraint& closure : revision) {
    id += ' ' + std::to_string(closure.from) + '-' + std::to_string(closure.to);
  }
  return id + " of " + std::to_string(best.records.front()) + '+' +
         std::to_string(best.records.back());
}

// The poses of the keyframes are still those of the best hypothesis.
Proposal MakeProposal(HypothesisKind kind, const Revision& revision, const MapHypothesis& best) {
  Proposal proposal;
  proposal.id = IdOf(kind, revision, best);
  proposal.record = RecordOf(kind, revision, best.keys);
  MapHypothesis& draft = proposal.draft;
  draft.kind = best.kind;
  draft.start = best.start;
  draft.keys =
      kind == HypothesisKind::kWithMatch ? With(revision, best.keys) : Without(revision, best.keys);
  draft.num_removed = best.num_removed + (kind == HypothesisKind::kWithMatch ? 0 : 1);
  draft.num_added = best.num_added + (kind == HypothesisKind::kWithMatch ? 1 : 0);
  draft.num_strained = best.num_strained;
  draft.relocated_step = best.relocated_step;
  draft.records = best.records;
  return proposal;
}

// Optimises the pose graphs of proposals and measures the maps that they make.
void Measure(const SearchContext& context, std::vector<Proposal>* proposals) {
  std::vector<KeyframeGraph> graphs;
  graphs.reserve(proposals->size());
  for (Proposal& proposal : *proposals) graphs.push_back(std::move(proposal.draft.keys));
  OptimizeEach(context.surfaces.graph().peers(), context.pool, &graphs);
  std::vector<std::vector<Pose2>> maps;
  maps.reserve(graphs.size());
  for (std::size_t i = 0; i < graphs.size(); ++i) {
    maps.push_back(
        PosesFollowingKeyframes(graphs[i], (*proposals)[i].draft.start->world_from_robot));
    (*proposals)[i].draft.keys = std::move(graphs[i]);
  }
  std::vector<MapConsistency> measured = context.meter.MeasureEach(maps, context.pool);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    (*proposals)[i].draft.consistency = std::move(measured[i]);
  }
}

class RevisedClosures : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    const Posterior& posterior = context->posterior;
    const int most = kMaxRevisions + (context->has_sessions ? kMaxBentPlaces : 0);
    if (best.num_removed + best.num_added >= most || !posterior.IsSuspicious(best.consistency))
      return {};
    const std::vector<Revision> revisions = Revisions(best, posterior);
    const std::size_t at_a_time = AtATime(revisions.size());
    std::vector<Proposal> proposals;
    double best_gain = 0.0;
    for (std::size_t begin = 0; begin < revisions.size() && best_gain < kPromisingGain;
         begin += at_a_time) {
      std::vector<Proposal> batch;
      for (std::size_t i = begin; i < std::min(begin + at_a_time, revisions.size()); ++i) {
        batch.push_back(MakeProposal(kind(), revisions[i], best));
      }
      Measure(*context, &batch);
      for (Proposal& proposal : batch) {
        proposal.draft.terms = best.terms;
        proposal.draft.terms.conflict = proposal.draft.consistency.AllConflicts();
        const double gain = (posterior.ScanEnergy(best.terms.conflict) -
                             posterior.ScanEnergy(proposal.draft.terms.conflict)) /
                            posterior.unit();
        proposal.is_promising = IsPromising(gain);
        best_gain = std::max(best_gain, gain);
        proposals.push_back(std::move(proposal));
      }
    }
    std::stable_sort(proposals.begin(), proposals.end(), [&](const Proposal& a, const Proposal& b) {
      return posterior.ScanEnergy(a.draft.terms.conflict) <
             posterior.ScanEnergy(b.draft.terms.conflict);
    });
    return proposals;
  }

 private:
  virtual HypothesisKind kind() const = 0;
  virtual std::vector<Revision> Revisions(const MapHypothesis& best,
                                          const Posterior& posterior) const = 0;
  virtual std::size_t AtATime(std::size_t num_revisions) const = 0;
  virtual bool IsPromising(double gain) const = 0;
};

class WithoutClusters : public RevisedClosures {
 protected:
  HypothesisKind kind() const override { return HypothesisKind::kWithoutCluster; }
  std::vector<Revision> Revisions(const MapHypothesis& best,
                                  const Posterior& posterior) const override {
    return SuspectClusters(best.keys, best.consistency, posterior.explicable_share());
  }
  std::size_t AtATime(std::size_t /*num_revisions*/) const override { return kClustersAtATime; }
  // The conflicts of a wrong cluster vanish with it.
  bool IsPromising(double gain) const override { return gain > 0.0; }
};

class WithoutRepeatedClusters : public WithoutClusters {
 private:
  std::vector<Revision> Revisions(const MapHypothesis& best,
                                  const Posterior& posterior) const override {
    return WithRepetitions(WithoutClusters::Revisions(best, posterior), best.keys);
  }
};

class TentativeClosures : public RevisedClosures {
 private:
  HypothesisKind kind() const override { return HypothesisKind::kWithMatch; }
  std::vector<Revision> Revisions(const MapHypothesis& best,
                                  const Posterior& /*posterior*/) const override {
    return TentativeMatches(best.keys);
  }
  std::size_t AtATime(std::size_t num_revisions) const override {
    return std::max<std::size_t>(1, num_revisions);
  }
  // The gain may come with the closures that a match brings into reach.
  bool IsPromising(double /*gain*/) const override { return true; }
};

class WithoutBentTies : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    if (!context->has_sessions || best.num_removed >= kMaxRevisions + kMaxBentPlaces) return {};
    const TiedPlace worst = MostBentPlace(best.keys, context->pool);
    if (!worst.is_bent()) return {};
    return {MakeProposal(HypothesisKind::kWithoutCluster, worst.closures, best)};
  }
};

}  // namespace

std::unique_ptr<Proposer> ProposeWithoutClusters() { return std::make_unique<WithoutClusters>(); }

std::unique_ptr<Proposer> ProposeWithoutRepeatedClusters() {
  return std::make_unique<WithoutRepeatedClusters>();
}

std::unique_ptr<Proposer> ProposeTentativeClosures() {
  return std::make_unique<TentativeClosures>();
}

std::unique_ptr<Proposer> ProposeWithoutBentTies() { return std::make_unique<WithoutBentTies>(); }

}  // namespace plumbline
