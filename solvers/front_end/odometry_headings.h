#ifndef PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_HEADINGS_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_HEADINGS_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"

namespace plumbline {

/// The trajectory with the headings of the odometry over long stretches: its steps keep the turns
/// of the matching, plus the mean over 12 m of path to either side by which the odometry differs.
/// Outdoors, where a scan sees few and rough surfaces, the heading of the matching drifts by a
/// degree every 10 m, and that of good wheels does not.
///
/// given: poses by odometry, one per pose. motion: its noise; steps whose difference is more than
/// noise (IsLeap) do not count.
SequentialTrajectory WithOdometryHeadings(const SequentialTrajectory& matched,
                                          const std::vector<Pose2>& given,
                                          const MotionOptions& motion);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_HEADINGS_H_
