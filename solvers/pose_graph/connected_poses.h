#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_CONNECTED_POSES_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_CONNECTED_POSES_H_

#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// The first pose that the graph's relative poses connect with none of these, by id; -1 if there is
/// no such pose.
int FindUnconnectedPose(const SlamGraph& graph, const std::vector<int>& anchors);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_CONNECTED_POSES_H_
