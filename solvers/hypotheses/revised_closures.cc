#include "plumbline/solvers/hypotheses/revised_closures.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/hypotheses/closure_revisions.h"
#include "plumbline/solvers/hypotheses/suspect_clusters.h"

namespace plumbline {
namespace {

// Maximum number of accepted revisions of one kind.
constexpr int kMaxRevisions = 6;
constexpr int kMaxBentPlaces = 12;
// Clusters are measured this many at a time, until one of them gains this many units.
constexpr std::size_t kClustersAtATime = 4;
constexpr double kPromisingGain = 0.5;

KeyframeGraph Revised(HypothesisKind kind, const Revision& revision, const KeyframeGraph& keys) {
  return kind == HypothesisKind::kWithMatch ? With(revision, keys) : Without(revision, keys);
}

// revised: the best hypothesis with its closures revised, optimised or not.
Proposal MakeProposal(HypothesisKind kind, const Revision& revision, KeyframeGraph revised,
                      const MapHypothesis& best) {
  Proposal proposal;
  proposal.id = ToString(kind) + IdOf(revision) + " of " + std::to_string(best.records.front()) +
                '+' + std::to_string(best.records.back());
  proposal.record = RecordOf(kind, revision, best.keys);
  MapHypothesis& draft = proposal.draft;
  draft.kind = best.kind;
  draft.start = best.start;
  draft.keys = std::move(revised);
  draft.assumed = best.assumed;
  ++(kind == HypothesisKind::kWithMatch ? draft.assumed.num_added : draft.assumed.num_removed);
  draft.relocated_step = best.relocated_step;
  draft.records = best.records;
  return proposal;
}

class RevisedClosures : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    const Posterior& posterior = context->posterior;
    const int most = kMaxRevisions + (context->has_sessions ? kMaxBentPlaces : 0);
    if (best.assumed.num_removed + best.assumed.num_added >= most ||
        !posterior.IsSuspicious(best.consistency)) {
      return {};
    }
    const std::vector<Revision> revisions = Revisions(best, posterior);
    const std::size_t at_a_time = AtATime(revisions.size());
    std::vector<Proposal> proposals;
    double best_gain = 0.0;
    for (std::size_t begin = 0; begin < revisions.size() && best_gain < kPromisingGain;
         begin += at_a_time) {
      const std::size_t end = std::min(begin + at_a_time, revisions.size());
      std::vector<KeyframeGraph> graphs;
      for (std::size_t i = begin; i < end; ++i) {
        graphs.push_back(Revised(kind(), revisions[i], best.keys));
      }
      OptimizeEach(context->surfaces.graph().peers(), context->pool, &graphs);
      const std::vector<MapConsistency> maps = context->Measure(graphs, *best.start);
      for (std::size_t i = begin; i < end; ++i) {
        Proposal proposal = MakeProposal(kind(), revisions[i], std::move(graphs[i - begin]), best);
        proposal.draft.consistency = maps[i - begin];
        proposal.draft.terms = best.terms;
        proposal.draft.terms.conflict = maps[i - begin].AllConflicts();
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
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* /*context*/) override {
    if (best.bent_places.empty() || best.assumed.num_removed >= kMaxRevisions + kMaxBentPlaces) {
      return {};
    }
    const auto worst = std::max_element(
        best.bent_places.begin(), best.bent_places.end(),
        [](const TiedPlace& a, const TiedPlace& b) { return a.relief < b.relief; });
    constexpr HypothesisKind kKind = HypothesisKind::kWithoutCluster;
    return {MakeProposal(kKind, worst->closures, Revised(kKind, worst->closures, best.keys), best)};
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
