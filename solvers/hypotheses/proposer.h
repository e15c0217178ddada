#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_PROPOSER_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_PROPOSER_H_

#include <memory>
#include <string>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/hypotheses/map_hypothesis.h"
#include "plumbline/solvers/hypotheses/posterior.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"

namespace plumbline {

/// What all proposers of a search share.
struct SearchContext {
  const MotionOptions& motion;
  const ScanSurfaces& surfaces;
  ThreadPool* pool;
  std::shared_ptr<const SequentialTrajectory> matched;  ///< by the sequential matching
  bool has_sessions;                                    ///< the drive is made of several sessions
  const ConsistencyMeter& meter;
  const Posterior& posterior;
  /// Pose graph of the matching, with the evidence against its steps.
  KeyframeGraph suspected;

  /// The maps of pose graphs with the keyframes of one start.
  std::vector<MapConsistency> Measure(const std::vector<KeyframeGraph>& graphs,
                                      const SequentialTrajectory& start) const;
};

/// Closures as a part of a proposal's id.
std::string IdOf(const std::vector<RelativePoseConstraint>& closures);

/// A hypothesis whose loops are still to be closed.
struct Proposal {
  std::string id;  ///< proposals with the same id are the same
  MapHypothesis draft;
  WeighedHypothesis record;  ///< its entry in the report
  /// The draft was measured: its poses and consistency are set, and need no search for closures.
  bool is_complete = false;
  /// Its loops are closed only if that is promising; otherwise it is only reported.
  bool is_promising = true;
};

/// A source of hypotheses.
class Proposer {
 public:
  virtual ~Proposer() = default;

  /// Proposals around the best hypothesis so far, the most promising first; none if there is
  /// nothing to say.
  virtual std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) = 0;

  /// True if the proposals exclude each other and all of them are to be weighed. Otherwise the
  /// search goes on around the first one that is better than the best hypothesis so far.
  virtual bool AreAlternatives() const { return false; }
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_PROPOSER_H_
