#ifndef PLUMBLINE_SOLVERS_FRONT_END_CORRECT_ODOMETRY_H_
#define PLUMBLINE_SOLVERS_FRONT_END_CORRECT_ODOMETRY_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"

namespace plumbline {

/// Gives the trajectory another odometry, and moves its poses where the matching had followed the
/// one before: along a bare corridor the length driven comes from it alone. Where the matches know
/// better, nothing moves.
/// corrected: from the pose before, one per pose. motion: what the matching had as the noise of its
/// prior.
void CorrectOdometry(std::vector<Pose2> corrected, const MotionOptions& motion,
                     SequentialTrajectory* trajectory);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_CORRECT_ODOMETRY_H_
