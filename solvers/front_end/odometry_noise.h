#ifndef PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_NOISE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_NOISE_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/odometry_report.h"

namespace plumbline {

/// Estimates the odometry's errors from its disagreement with the sequential matching, over spans
/// of keyframes of at least 1 m or 1 rad. Spans count only where the matches know the quantity
/// better than the odometry: along a bare corridor the match follows the odometry. Errors count as
/// three standard deviations at most.
///
/// An alpha of MotionOptions is chosen so that the variances that it alone causes, summed over all
/// steps, are what the random error grows to over the log; for steps of one length s [m],
/// alpha_3 = sigma_per_sqrt_m / sqrt(s). An alpha whose motion the log lacks, or whose random error
/// is not estimated, is as in `given`; so are the floors.
///
/// given: the noise of the matching's prior.
OdometryNoiseReport EstimateOdometryNoise(const SequentialTrajectory& trajectory,
                                          const MotionOptions& given);

/// Least error of a step of the odometry that is more than noise: the larger one of a length or an
/// angle and six standard deviations.
constexpr double kLeapM = 0.2, kLeapRad = 0.2, kLeapSigmas = 6.0;

/// Whether the difference of odometry and matching on a step is more than noise.
bool IsLeap(const Pose2& odometry, const Pose2& matched, const MotionOptions& motion);

/// The noise that suits the joint estimation on the corrected odometry, never more than `given`.
/// Forward motion gets the noise that the scans show: along a bare corridor whose end the laser
/// does not see, only the odometry holds the map. Its floor is at most 5 mm: errors that come and
/// go with each step, such as clocks that differ a little. Turns keep `given`, loose on purpose:
/// stiff ones bend corridors.
MotionOptions RefinementMotion(const OdometryNoiseReport& report, const MotionOptions& given);

/// The step of the odometry without its significant systematic errors.
Pose2 CorrectStep(const Pose2& step, const OdometryNoiseReport& report);

/// Gives the trajectory another odometry, and moves its poses where the matching had followed the
/// one before, as along a bare corridor. Where the matches know better, nothing moves.
/// corrected: from the pose before, one per pose. motion: the noise of the matching's prior.
void CorrectOdometry(std::vector<Pose2> corrected, const MotionOptions& motion,
                     SequentialTrajectory* trajectory);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_NOISE_H_
