#ifndef PLUMBLINE_CORE_JOINED_RETURNS_H_
#define PLUMBLINE_CORE_JOINED_RETURNS_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Measured ends [m] of a scan's beams, in the order of its returns and in the frame of its robot.
void MeasuredPoints(const SlamGraph& graph, int scan_id, std::vector<Eigen::Vector2d>* points);

/// Tells for each return of a scan whether one surface joins it to the return before: at most one
/// return is missing between them, their beams are at most 0.3 rad apart, and the range does not
/// jump. If a driver drops every other beam, the others count as neighbours. Returns within reach_m
/// [m] of each other are joined even if the surface would have to run along the beam: noise cannot
/// be told from a step. points: as MeasuredPoints gives them. The first return is never joined.
void FindJoinedReturns(const SlamGraph& graph, int scan_id,
                       const std::vector<Eigen::Vector2d>& points, double reach_m,
                       std::vector<bool>* joined);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_JOINED_RETURNS_H_
