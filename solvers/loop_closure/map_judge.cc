#include "plumbline/solvers/loop_closure/map_judge.h"

#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {

void MapJudge::TakeMeasure(const MapConsistency& map) {
  explicable_share_ = map.ExplicableShare();
  worth_of_agreement_ = map.WorthOfAgreement();
}

double MapJudge::Score(const MapConsistency& map) const {
  const FreeSpaceConflict all = map.AllConflicts();
  return all.num_conflicting - worth_of_agreement_ * all.num_compared;
}

double MapJudge::Gain(const MapConsistency& map, const MapConsistency& other) const {
  const double enough = LoopAcceptance::kMinMapGain * other.between_passes.num_conflicting +
                        LoopAcceptance::kMinMapGainReturns;
  return (Score(other) - Score(map)) / enough;
}

bool MapJudge::IsSuspicious(const MapConsistency& map) const {
  return map.Ratio() > MapConsistency::kSuspiciousRatio || map.IsContradictory() ||
         PassesDisagree(map);
}

bool MapJudge::PassesDisagree(const MapConsistency& map) const {
  return of_one_session_ && map.PassesDisagree();
}

}  // namespace plumbline
