#ifndef PLUMBLINE_SOLVERS_WINDOW_CONTEXT_H_
#define PLUMBLINE_SOLVERS_WINDOW_CONTEXT_H_

#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/sliding_window.h"

namespace plumbline {

/// The poses that hold the map around free ones, ascending: the other ends of constraints on free
/// poses, and those that saw the same places, see WindowOptions. free_poses: known ids, each once,
/// within reach.
std::vector<int> ChooseFixedPoses(const WindowOptions& options, const SlamGraph& graph,
                                  const MapState& state, const std::vector<int>& free_poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_WINDOW_CONTEXT_H_
