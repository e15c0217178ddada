#ifndef PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_NOISE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_NOISE_H_

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/odometry_report.h"

namespace plumbline {

/// Estimates the odometry's errors from how it disagrees with the sequential matching, over spans
/// of keyframes of at least 1 m or 1 rad, on which they stand out from the matching's own. Spans
/// count only where the matches know the quantity better than the odometry: along a bare corridor
/// the match follows the odometry, and would find it perfect.
///
/// Slips enlarge the sigmas, but each counts as an error of three standard deviations at most.
///
/// The sigmas of MotionOptions are proportional to a step, and those of independent errors add up
/// in squares: an alpha is chosen so that the sum over all steps of the variance that it alone
/// causes, by MotionCovariance, is what the random error grows to over the log. For steps of one
/// length s [m] that is alpha_3 = sigma_per_sqrt_m / sqrt(s). An alpha whose motion the log
/// lacks, or whose random error is not estimated, is as in `given`; so are the floors, which are
/// added to it.
///
/// given: what the matching had as the noise of its prior.
OdometryNoiseReport EstimateOdometryNoise(const SequentialTrajectory& trajectory,
                                          const MotionOptions& given);

/// Whether odometry and matching disagree on a step too much for noise, as
/// OdometryNoiseReport::num_leaps has it.
bool IsLeap(const Pose2& odometry, const Pose2& matched, const MotionOptions& motion);

/// The noise that suits the joint estimation on the corrected odometry, never more than `given`.
/// Forward motion has what the scans say of it, where they say anything: with a scanner that does
/// not see the end of a bare corridor nothing but the odometry holds the map along it, and the
/// loose defaults let it go by centimetres. The floor is then 5 mm at most: the alpha has all that
/// grows, and the floor what comes and goes with each step, such as clocks that are not quite
/// together. Turns keep `given`, loose on purpose: stiff ones bend corridors.
MotionOptions RefinementMotion(const OdometryNoiseReport& report, const MotionOptions& given);

/// The step of the odometry without its significant systematic errors.
Pose2 CorrectStep(const Pose2& step, const OdometryNoiseReport& report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_NOISE_H_
