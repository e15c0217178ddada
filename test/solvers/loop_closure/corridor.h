#ifndef PLUMBLINE_TEST_SOLVERS_LOOP_CLOSURE_CORRIDOR_H_
#define PLUMBLINE_TEST_SOLVERS_LOOP_CLOSURE_CORRIDOR_H_

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"

namespace plumbline {

/// A straight corridor there and back, a keyframe per metre.
inline KeyframeGraph Corridor() {
  KeyframeGraph keys;
  for (int k = 0; k <= 80; ++k) {
    Keyframe key;
    key.pose = key.scan = k;
    key.path_m = k;
    keys.keyframes.push_back(key);
    keys.world_from_key.emplace_back(k <= 40 ? k : 80.0 - k, 0.0, 0.0);
  }
  return keys;
}

/// A closure between two of its keyframes.
inline RelativePoseConstraint Closure(int from, int to, const Pose2& from_from_to = Pose2()) {
  RelativePoseConstraint closure;
  closure.from = from;
  closure.to = to;
  closure.from_from_to = from_from_to;
  return closure;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_SOLVERS_LOOP_CLOSURE_CORRIDOR_H_
