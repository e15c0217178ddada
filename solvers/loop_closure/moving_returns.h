#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_

#include <optional>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/free_space.h"

namespace plumbline {

/// Finds the returns of people and all else that moves: a scan shortly before looks through them,
/// and so does one shortly after; or one of them does, and none sees anything there. Where the
/// poses jump, the scans on one side of the jump look through returns that those on the other side
/// see, so what tells of it is not found. Nor is anything of a scan of which more than two fifths
/// would be: it is out of place itself.
///
/// scans: along the path, by their ids among all. world_from_robot: one finite pose per pose of the
/// graph. free_space: of those scans that the graph has. Collective if the graph has peers.
///
/// Returns per scan, those of other processes included, places among its returns().
std::vector<std::vector<int>> FindMovingReturns(
    const SlamGraph& graph, const std::vector<int>& scans,
    const std::vector<Pose2>& world_from_robot,
    const std::vector<std::optional<FreeSpaceScan>>& free_space, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_
