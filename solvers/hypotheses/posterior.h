#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_POSTERIOR_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_POSTERIOR_H_

#include <limits>

#include "plumbline/solvers/hypotheses/map_hypothesis.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// The negative log posterior ("energy") by which hypotheses about a drive are compared, in units
/// of one conflicting return:
///
///     conflicting - usual_share * compared  +  unit * assumptions  +  50 / m * relocated
///
/// The first two terms are the conflicting returns beyond the usual share of the returns compared
/// (MapConsistency). Agreement counts no more than that: in a building that repeats itself, wrong
/// places agree as well. The other terms are the prior of the assumptions beyond a plain drive: a
/// slip or a relocation of the robot, closures removed or added, another source of the odometry. A
/// slip that strains the pose graph costs its size only, since the closures show it. A step at
/// which the scans disagree costs like a long relocation if nothing tells where it leads.
/// Each session that is bent by its closures with others at one place costs more than removing
/// them.
class Posterior {
 public:
  /// Between sessions furniture moves: their passes may disagree without reason for suspicion.
  explicit Posterior(bool of_one_session) : of_one_session_(of_one_session) {}

  /// Takes the explicable share from the map of the sequential matching.
  void Begin(const MapConsistency& matching);

  /// Calibrates the usual share and the cost of an assumption on the best map so far. They only
  /// fall: a wrong map has more conflicts than are usual.
  void Calibrate(const MapConsistency& best);

  /// Share of the conflicting returns that can be explained; see MapConsistency.
  double explicable_share() const { return explicable_share_; }
  /// Energy of one assumption.
  double unit() const { return unit_; }

  /// Conflicting returns beyond the usual share of those compared.
  double ScanEnergy(const FreeSpaceConflict& conflict) const;
  double Energy(const EnergyTerms& terms) const;

  /// The terms of a hypothesis with closed loops.
  static EnergyTerms TermsOf(const MapHypothesis& hypothesis);

  /// True if a map contradicts itself by enough to look for another one.
  bool IsSuspicious(const MapConsistency& map) const;
  /// MapConsistency::PassesDisagree for the map of one session; else false.
  bool PassesDisagree(const MapConsistency& map) const;

 private:
  const bool of_one_session_;
  double explicable_share_ = 0.0;
  double usual_share_ = std::numeric_limits<double>::infinity();
  double unit_ = std::numeric_limits<double>::infinity();
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_POSTERIOR_H_
