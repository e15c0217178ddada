#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

namespace plumbline {

/// Scans with returns, each at least `spacing_m` away or turned by `spacing_rad` from the one
/// before it, by their ids among all. world_from_robot: per pose.
std::vector<int> ScansAlongPath(const SlamGraph& graph, const std::vector<Pose2>& world_from_robot,
                                double spacing_m, double spacing_rad);

/// Finds the returns of people and of everything else that moves. A return moves if a witness
/// shortly before its scan and one shortly after look through it; or, where both sides have a
/// witness within 1 m, if one side does and none sees a surface there. At a jump of the poses one
/// side looks through returns that the other side sees: they do not count as moving. Nothing is
/// found in a scan of which more than two fifths would move: its pose is wrong.
///
/// scans, witnesses: ids among all; witnesses in order of the path. world_from_robot: one finite
/// pose per pose of the graph. Collective if the graph has peers.
///
/// Returns places among FreeSpaceScan::returns() per scan, those of other processes included.
std::vector<std::vector<int>> FindMovingReturns(const ScanSurfaces& surfaces,
                                                const std::vector<int>& scans,
                                                const std::vector<int>& witnesses,
                                                const std::vector<Pose2>& world_from_robot,
                                                ThreadPool* pool);

/// Finds the moving returns of all scans of a drive, as far as they are of objects of a person's or
/// a cart's size. Witnesses stand 0.1 m or 10 deg apart, so that people around a standing robot are
/// found as well. Finds none unless a sample of the scans has more than kFewMoving: fewer do not
/// harm the matching.
///
/// Returns ids among all returns, those of other processes included, in order; see
/// MeasurementCorrections. Collective if the graph has peers.
std::vector<std::size_t> FindMovingReturnsOfDrive(const ScanSurfaces& surfaces,
                                                  const std::vector<Pose2>& world_from_robot,
                                                  ThreadPool* pool);

/// Share of moving returns that does not harm the matching. fr079, intel, mit-killian, acapulco,
/// orebro, infinite-corridor and fr-clinic have less; four people around the robot are 0.09.
constexpr double kFewMoving = 0.02;

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_MOVING_RETURNS_H_
