#ifndef PLUMBLINE_CORE_FIXED_POSES_H_
#define PLUMBLINE_CORE_FIXED_POSES_H_

#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Whether all fixed poses of the graph are where they were fixed, exactly.
bool IsAtFixedPoses(const SlamGraph& graph, const MapState& state);

/// Puts a state where the graph's fixed poses are: the whole of it, rigidly, by the first one that
/// FixPose named, and then the others with their map points, if it has any. Nothing changes where
/// all are in place.
void PutAtFixedPoses(const SlamGraph& graph, MapState* state);

/// Moves every map point along with its pose, from poses_before (x, y, yaw each) to the state's: it
/// keeps its place in the frame of its robot.
void CarryPoints(const SlamGraph& graph, const std::vector<double>& poses_before, MapState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_FIXED_POSES_H_
