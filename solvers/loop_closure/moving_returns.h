#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

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

/// Likewise the returns of what moves in all scans of a drive, as far as they are of objects of a
/// person's or a cart's size. Scans before and after are those from other places, so what moves
/// while the robot stands is found as well. Finds none unless a sample of the scans has more than
/// kFewMoving: fewer do not harm the matching.
///
/// Returns ids among all returns, those of other processes included, in order; see
/// MeasurementCorrections. Collective if the graph has peers.
std::vector<std::size_t> FindMovingReturnsOfDrive(const ScanSurfaces& surfaces,
                                                  const std::vector<Pose2>& world_from_robot,
                                                  ThreadPool* pool);

/// fr079, intel, mit-killian, acapulco, orebro, infinite-corridor and fr-clinic have less; with
/// four people around the robot it is 0.09.
constexpr double kFewMoving = 0.02;

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_
