#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_

#include <optional>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/free_space.h"

namespace plumbline {

/// Finds the returns of people and all else that moves. A scan shortly before looks through them,
/// and so does one shortly after; or, where there are scans within 1 m on both sides, one of them
/// does and none sees anything there. At a jump of the poses, the scans on one side look through
/// returns that those on the other side see, so what tells of it is not found, unless another jump
/// leads back within a few metres. Nothing is found of a scan of which more than two fifths would
/// be: it is out of place itself. What one session's end and the next one's beginning see of each
/// other counts like the rest.
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
