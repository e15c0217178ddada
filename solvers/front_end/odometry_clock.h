#ifndef PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_CLOCK_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_CLOCK_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/odometry_report.h"

namespace plumbline {

/// Estimates how far the clocks of odometry and laser are apart (a temporal calibration), up to
/// 1 s: the offset at which the turns of the odometry fit those of the matching best. Unknown
/// (sigma 0) where the turns allow several offsets or an end of that range, as on a drive without
/// turns, and where stamps fall or repeat. The matching began at the odometry as it was, which
/// draws the estimate a little towards 0.
ClockOffset EstimateClockOffset(const SlamGraph& graph, const SequentialTrajectory& trajectory);

/// The steps that the odometry would have had at the times of the scans. Between them the robot is
/// taken to move steadily. Steps that reach into a gap of more than 1 s, before the first scan or
/// beyond the last one, stay as they are.
/// odometry: from the pose before, one per pose; entry 0 is unused.
std::vector<Pose2> OdometryInTime(const SlamGraph& graph, const std::vector<Pose2>& odometry,
                                  double offset_s);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_CLOCK_H_
