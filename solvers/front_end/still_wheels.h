#ifndef PLUMBLINE_SOLVERS_FRONT_END_STILL_WHEELS_H_
#define PLUMBLINE_SOLVERS_FRONT_END_STILL_WHEELS_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"

namespace plumbline {

/// Steps over which the odometry reports hardly any translation while the scans move: blocked or
/// lifted wheels, an encoder that failed for a while, or a robot that is pushed or carried with its
/// laser running.
///
/// odometry: one step per pose, from the pose before. matched: of a matching without odometry.
/// Returns for each pose whether the step to it is one of these.
std::vector<char> FindStillWheels(const std::vector<Pose2>& odometry,
                                  const SequentialTrajectory& matched);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_STILL_WHEELS_H_
