#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_MAP_JUDGE_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_MAP_JUDGE_H_

#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// Compares maps of the same scans, by what their scans say of free space. LoopAcceptance has the
/// thresholds.
class MapJudge {
 public:
  /// Between several sessions furniture moves: that their passes disagree is no reason for
  /// suspicion.
  explicit MapJudge(bool of_one_session) : of_one_session_(of_one_session) {}

  /// Takes from a map of the scans what agreement is worth: the same for all that are compared.
  void TakeMeasure(const MapConsistency& map);

  /// Share of the conflicting returns that can be explained. See MapConsistency.
  double explicable_share() const { return explicable_share_; }

  /// Conflicting returns less what the compared ones are worth; the lower, the better.
  double Score(const MapConsistency& map) const;

  /// Whether one map is better than another by enough to assume more for it.
  bool IsBetter(const MapConsistency& map, const MapConsistency& other) const {
    return Gain(map, other) > 1.0;
  }

  /// How much better a map is than another, as a multiple of what is enough.
  double Gain(const MapConsistency& map, const MapConsistency& other) const;

  /// Whether a map contradicts itself by enough to look for another one.
  bool IsSuspicious(const MapConsistency& map) const;

  /// MapConsistency::PassesDisagree of the map of one session.
  bool PassesDisagree(const MapConsistency& map) const;

 private:
  const bool of_one_session_;
  double explicable_share_ = 0.06;
  double worth_of_agreement_ = 0.06;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_MAP_JUDGE_H_
