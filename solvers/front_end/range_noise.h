#ifndef PLUMBLINE_SOLVERS_FRONT_END_RANGE_NOISE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_RANGE_NOISE_H_

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Standard deviation of a range reading [m], rounding included: by how far the middle one of three
/// neighbouring beams ends from the line through the ends of the others, where these meet a surface
/// at 45 degrees or steeper. Uses the better half of the triples, which has few corners, jumps and
/// leaves. 0 if there are too few triples. The work is bounded.
double MeasureRangeNoise(const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_RANGE_NOISE_H_
