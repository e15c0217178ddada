#ifndef PLUMBLINE_SOLVERS_FRONT_END_RANGE_NOISE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_RANGE_NOISE_H_

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Standard deviation of a range reading [m], by how far the middle one of three neighbouring beams
/// ends from the straight line through the ends of the others, where these lie on a surface that
/// the beam meets at 45 degrees or steeper. By the better half of them: walls are straight there,
/// and few corners, jumps and leaves are among it. The rounding of readings counts as noise.
///
/// 0 where there are too few such beams to tell. The work is bounded.
double MeasureRangeNoise(const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_RANGE_NOISE_H_
