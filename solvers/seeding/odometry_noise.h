#ifndef PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_NOISE_H_
#define PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_NOISE_H_

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/sequential_seeding.h"

namespace plumbline {

/// An error of the odometry that stays the same for the whole log: what it reads too much, per unit
/// of the true motion, and the standard deviation of that estimate.
struct SystematicError {
  double value = 0.0;
  double sigma = 0.0;

  /// Beyond four standard deviations: chance makes less than one log in ten thousand look so. Not
  /// from 0.5 on: such an odometry does not measure, and no factor mends it.
  bool IsSignificant() const;
};

/// Growth of the random error of one quantity, forward motion [m] or turn [rad]. Errors of
/// different steps are independent: after driving d metres and turning t radians (lengths, never
/// negative) the variance is sigma_per_sqrt_m^2 d + sigma_per_sqrt_rad^2 t.
struct RandomError {
  bool estimated = false;  ///< false if there were too few spans: the sigmas are 0, not known
  int num_spans = 0;       ///< stretches of about 1 m or 1 rad that the scan matching measured
  double sigma_per_sqrt_m = 0.0;
  double sigma_per_sqrt_rad = 0.0;
};

/// What the scan matching says of the odometry, in the frame of the robot.
struct OdometryNoiseReport {
  SystematicError translation_scale;    ///< [m per m]
  SystematicError rotation_scale;       ///< [rad per rad]
  SystematicError heading_drift_rad_m;  ///< turn per metre driven forward [rad/m]
  RandomError translation;              ///< of the forward motion [m]
  RandomError rotation;                 ///< of the turn [rad]
  /// Steps that odometry and matching disagree on by more than 0.2 m or 0.2 rad, and by more than
  /// six standard deviations of `motion`. A slip, a collision, or a match to the wrong place.
  int num_leaps = 0;
  /// The random errors as noise of a single step of this log.
  MotionOptions motion;
};

/// Estimates the odometry's errors from how it disagrees with the sequential matching, over spans
/// of key scans of at least 1 m or 1 rad, on which they stand out from the matching's own. Spans
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

#endif  // PLUMBLINE_SOLVERS_SEEDING_ODOMETRY_NOISE_H_
