#ifndef PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_CLOCK_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_CLOCK_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/odometry_report.h"

namespace plumbline {

/// Estimates how far the clocks of odometry and laser are apart, up to 1 s, from the turns: the
/// offset at which the odometry's turns fit the matched ones best, together with a constant error
/// of the odometry per radian and per metre. Not significant where the robot hardly turns, and
/// where the scans have no times.
ClockOffset EstimateClockOffset(const SlamGraph& graph, const SequentialTrajectory& trajectory);

/// The steps that the odometry would have had at the times of the scans. Between them the robot is
/// taken to move steadily. Steps that began before the first or end after the last known moment
/// stay as they are.
/// odometry: from the pose before, one per pose; entry 0 is unused.
std::vector<Pose2> OdometryInTime(const SlamGraph& graph, const std::vector<Pose2>& odometry,
                                  double offset_s);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_CLOCK_H_
