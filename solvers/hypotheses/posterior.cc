#include "plumbline/solvers/hypotheses/posterior.h"

#include <algorithm>
#include <cmath>

#include "plumbline/solvers/hypotheses/relocated_segments.h"

namespace plumbline {
namespace {

// The unit of assumptions: the number of returns that moved people and chairs bring into conflict,
// a constant and a share of the conflicts between passes. fr079, intel and mit-killian have the
// same closures at 30 and 300 returns, and at 0.05 and 0.2.
constexpr double kUnitReturns = 100.0;
constexpr double kUnitShare = 0.1;
// Energy of a metre by which the robot slipped or was relocated. Tuned on the floors of the seeding
// study (apps/benchmark).
constexpr double kEnergyPerM = 50.0;
// A step at which the scans disagree, with nothing to tell where it leads, costs like a relocation
// by this distance [m].
constexpr double kUnknownM = 20.0;
// Costs of assumptions, in units. A unit stands for odds of about 1 : 50, a quarter
// for 1 : 3.
constexpr double kSlipOrRelocation = 1.0;
constexpr double kRemovedCluster = 1.0;
constexpr double kAddedClosure = 0.25;  // a match that was nearly good enough
constexpr double kGivenOdometry = 1.0;
constexpr double kOdometryHeadings = 0.25;
// A session that is bent at one place by its closures with others: more than the cost of removing
// them.
constexpr double kBentPlace = 2.0;

double CostOfStart(HypothesisKind kind) {
  switch (kind) {
    case HypothesisKind::kOdometry:
    case HypothesisKind::kOdometryAlone:
      return kGivenOdometry;
    case HypothesisKind::kOdometryHeadings:
      return kOdometryHeadings;
    default:
      return 0.0;
  }
}

}  // namespace

void Posterior::Begin(const MapConsistency& matching) {
  explicable_share_ = matching.ExplicableShare();
}

void Posterior::Calibrate(const MapConsistency& best) {
  usual_share_ = std::min(usual_share_, best.UsualShare());
  unit_ = std::min(unit_, kUnitReturns + kUnitShare * best.between_passes.num_conflicting);
}

double Posterior::ScanEnergy(const FreeSpaceConflict& conflict) const {
  return conflict.num_conflicting - usual_share_ * conflict.num_compared;
}

double Posterior::Energy(const EnergyTerms& terms) const {
  return ScanEnergy(terms.conflict) + unit_ * terms.assumptions + kEnergyPerM * terms.relocated_m;
}

EnergyTerms Posterior::TermsOf(const MapHypothesis& hypothesis) {
  EnergyTerms terms;
  terms.conflict = hypothesis.consistency.AllConflicts();
  const Assumptions& assumed = hypothesis.assumed;
  terms.assumptions = CostOfStart(hypothesis.kind) + kRemovedCluster * assumed.num_removed +
                      kAddedClosure * assumed.num_added - kSlipOrRelocation * assumed.num_strained +
                      kBentPlace * static_cast<double>(hypothesis.bent_places.size());
  for (const SequentialEdge& edge : hypothesis.keys.sequential) {
    if (!edge.broken || edge.between_sessions) continue;
    const Pose2 slip =
        Between(edge.constraint.from_from_to, StepAt(edge.constraint.from, hypothesis.keys));
    terms.assumptions += kSlipOrRelocation;
    terms.relocated_m += std::hypot(slip.x, slip.y);
  }
  for (const SuspectStep& suspect : hypothesis.loops.suspect_steps) {
    if (!suspect.IsUntied()) continue;
    if (!suspect.broken) terms.assumptions += kSlipOrRelocation;
    terms.relocated_m += kUnknownM;
  }
  return terms;
}

bool Posterior::IsSuspicious(const MapConsistency& map) const {
  return map.Ratio() > MapConsistency::kSuspiciousRatio || map.IsContradictory() ||
         PassesDisagree(map);
}

bool Posterior::PassesDisagree(const MapConsistency& map) const {
  return of_one_session_ && map.PassesDisagree();
}

}  // namespace plumbline
