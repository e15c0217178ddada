#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSURE_MEMORY_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSURE_MEMORY_H_

#include <Eigen/Core>
#include <unordered_map>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/loop_closure/loop_candidates.h"
#include "plumbline/solvers/loop_closure/loop_closure.h"

namespace plumbline {

/// Results of the candidates that were tested before: a place is searched once per relative window,
/// however many rounds and hypotheses come back to it. The keyframes must stay the same; their
/// poses may change.
class ClosureMemory {
 public:
  /// The result of an earlier test that stands for this candidate, or null: of the same keyframe
  /// and place, in a window that contained this one, with the match, if any, within this one.
  const TestedCandidate* Find(const LoopCandidate& candidate, const KeyframeGraph& keys) const;

  /// keys: at the time of the test.
  void Add(const LoopCandidate& candidate, const KeyframeGraph& keys,
           const TestedCandidate& tested);

 private:
  // A candidate as it was tested.
  struct Entry {
    int first = 0;
    double drift_m = 0.0, drift_rad = 0.0;
    Pose2 first_from_second;  // as predicted then
    int num_surroundings = 0;
    Eigen::Vector2d surroundings_center = Eigen::Vector2d::Zero();  // in the frame of `first` [m]
    TestedCandidate tested;
  };

  static Entry EntryOf(const LoopCandidate& candidate, int first, const KeyframeGraph& keys);
  static bool Covers(const Entry& before, const LoopCandidate& candidate,
                     const KeyframeGraph& keys);

  std::unordered_map<int, std::vector<Entry>> of_second_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSURE_MEMORY_H_
