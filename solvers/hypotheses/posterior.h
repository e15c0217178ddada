#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_POSTERIOR_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_POSTERIOR_H_

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/hypotheses/map_hypothesis.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// The negative log posterior ("energy") by which hypotheses about a drive are compared, in units
/// of one conflicting return:
///
///     conflicting - worth * compared  +  unit * assumptions  +  50 / m * relocated
///
/// The first two terms are what the scans say of free space (MapConsistency). The others are the
/// prior of the assumptions beyond a plain drive: a slip or a relocation of the robot,
/// closures removed or added, another source of the odometry. A segment that its closures strain
/// costs as much as a slip, and each session that is bent by its closures with others at one
/// place costs more than removing them.
class Posterior {
 public:
  /// Between sessions furniture moves: their passes may disagree without reason for suspicion.
  explicit Posterior(bool of_one_session) : of_one_session_(of_one_session) {}

  /// Calibrates the worth of agreement on the map of the sequential matching.
  void Calibrate(const MapConsistency& reference);

  /// Lowers the cost of an assumption to the noise of this map, if that is lower.
  void LowerUnit(const MapConsistency& best);

  /// Share of the conflicting returns that can be explained; see MapConsistency.
  double explicable_share() const { return explicable_share_; }
  /// Energy of one assumption.
  double unit() const { return unit_; }

  /// Conflicting returns less the worth of all that were compared.
  double ScanEnergy(const MapConsistency& map) const;
  double Energy(const EnergyTerms& terms) const;

  /// The terms of a hypothesis with closed loops.
  EnergyTerms TermsOf(const MapHypothesis& hypothesis, ThreadPool* pool) const;

  /// True if a map contradicts itself by enough to look for another one.
  bool IsSuspicious(const MapConsistency& map) const;
  /// MapConsistency::PassesDisagree for the map of one session; else false.
  bool PassesDisagree(const MapConsistency& map) const;

 private:
  const bool of_one_session_;
  double explicable_share_ = 0.06;
  double worth_of_agreement_ = 0.06;
  double unit_ = 0.0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_POSTERIOR_H_
