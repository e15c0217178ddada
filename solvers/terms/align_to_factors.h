#ifndef PLUMBLINE_SOLVERS_TERMS_ALIGN_TO_FACTORS_H_
#define PLUMBLINE_SOLVERS_TERMS_ALIGN_TO_FACTORS_H_

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Where custom factors hold the map in the world (SlamGraph::fixed_poses() is empty): moves the
/// state as a whole, points along, to where they cost least. Sought from twelve headings, as a map
/// may begin with any. The state stays if poses are fixed, or if the cost falls by no more than
/// least_gain.
void AlignToFactors(const SlamGraph& graph, MapState* state, double least_gain = 0.0);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_ALIGN_TO_FACTORS_H_
