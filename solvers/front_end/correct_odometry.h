#ifndef PLUMBLINE_SOLVERS_FRONT_END_CORRECT_ODOMETRY_H_
#define PLUMBLINE_SOLVERS_FRONT_END_CORRECT_ODOMETRY_H_

#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"

namespace plumbline {

/// Takes the significant systematic errors out of the trajectory's odometry, and moves its poses
/// where the matching had followed that odometry: along a bare corridor the length driven comes
/// from it alone. Where the matches know better, nothing moves.
/// motion: what the matching had as the noise of its prior.
void CorrectOdometry(const OdometryNoiseReport& noise, const MotionOptions& motion,
                     SequentialTrajectory* trajectory);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_CORRECT_ODOMETRY_H_
