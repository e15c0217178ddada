#include "plumbline/solvers/interface/map_consistency.h"

#include <algorithm>

namespace plumbline {

namespace {

// These thresholds were tuned on the simulated floors of the seeding study (apps/benchmark), those
// that put peaks to what is usual on mit-killian, infinite-corridor, acapulco and fr-clinic. What
// is said of logs below are the seeds of these, fr079, intel and orebro, with returns of what
// moves.

// The share that doors and furniture that moved bring about, and the one of a crowd; see
// ExplicableShare(). Between passes of sound maps conflict 0.004 (intel) to 0.04 (corridors with
// people), 0.06 on the thinned log of orebro; outdoors, between bushes, 0.09 (fr-clinic).
constexpr double kDoorsShare = 0.06;
constexpr double kCrowdShare = 0.1;
// Peaks are put to this many times what is usual on the drive, ...
constexpr double kPeakOverUsual = 6.0;
// ... but what is usual excuses no more than this: on a drive outdoors, between bushes, it does.
constexpr double kMaxExcuse = 3.0;
// A map is wrong all over if what is at rest usually conflicts more than can be explained.
constexpr double kMaxUsualRatio = 1.0;
// Where this share of the stretches contradict others, what is usual is no excuse.
constexpr double kMaxContradictedShare = 0.25;

}  // namespace

double MapConsistency::RatioOf(const FreeSpaceConflict& conflict, double explicable_share) {
  return (conflict.num_conflicting / explicable_share + kPriorReturns) /
         (conflict.num_compared + kPriorReturns);
}

bool MapConsistency::PassesDisagree() const {
  return between_passes.Share() > kMaxBetweenOverWithin * UsualShare();
}

double MapConsistency::ExplicableShare() const {
  return std::min(std::max(within_pass.Share(), kDoorsShare), kCrowdShare);
}

double MapConsistency::UsualShare() const { return std::max(within_pass.Share(), kLeastShare); }

FreeSpaceConflict MapConsistency::AllConflicts() const {
  FreeSpaceConflict all = within_pass;
  all += between_passes;
  return all;
}

double MapConsistency::Ratio(const ConflictPeak& peak) const {
  return RatioOf(peak.conflict, ExplicableShare()) /
         std::clamp(kPeakOverUsual * peak.usual_ratio, 1.0, kMaxExcuse);
}

bool MapConsistency::IsContradictory(const ConflictPeak& peak) const {
  return Ratio(peak) > kMaxRatio;
}

bool MapConsistency::IsContradictory() const {
  return IsContradictory(WorstPeak()) || contradicted_share > kMaxContradictedShare ||
         usual_ratio_at_rest > kMaxUsualRatio;
}

const ConflictPeak& MapConsistency::WorstPeak() const {
  return Ratio(worst_within) > Ratio(worst_between) ? worst_within : worst_between;
}

}  // namespace plumbline
