#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_SCANS_ALONG_PATH_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_SCANS_ALONG_PATH_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Scans with returns, each so far or so much turned from the one before it; by their ids among all
/// of the graph and its peers. world_from_robot: per pose.
std::vector<int> ScansAlongPath(const SlamGraph& graph, const std::vector<Pose2>& world_from_robot,
                                double spacing_m, double spacing_rad);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_SCANS_ALONG_PATH_H_
