#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_STRAINED_STRETCHES_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_STRAINED_STRETCHES_H_

#include <utility>
#include <vector>

#include "plumbline/solvers/front_end/keyframe_graph.h"

namespace plumbline {

/// Squared error of the sequential edges from keyframe `first` to keyframe `end` that are not
/// broken.
double StepsChi2(const KeyframeGraph& keys, int first, int end);

/// What a stretch of sequential edges may be off by, in squared errors. Scans match better than
/// their covariances say: on sound drives the graph is off by a hundredth of what they allow.
double MostStrain(const KeyframeGraph& keys);

/// From keyframe to keyframe, between the ends of neighbouring closures.
std::vector<std::pair<int, int>> StretchesBetweenClosures(const KeyframeGraph& keys);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_STRAINED_STRETCHES_H_
