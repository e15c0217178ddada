#ifndef PLUMBLINE_SOLVERS_INTERFACE_ODOMETRY_REPORT_H_
#define PLUMBLINE_SOLVERS_INTERFACE_ODOMETRY_REPORT_H_

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"

namespace plumbline {

/// Some drivers log the length of a motion and lose its sign: the robot backs up, the odometry says
/// forward. What the data says about that.
struct OdometrySignReport {
  /// Steps of the odometry that go backwards. One is enough: this odometry has a sign.
  int num_backward_steps = 0;
  /// Steps that scan matching alone, blind to the odometry's translation, could decide.
  int num_decided = 0;
  /// Of these, steps that went backwards by about the length that the odometry calls forward, and
  /// so did the next two decided ones.
  int num_contradicting = 0;
  bool sign_lost = false;  ///< what follows from these
};

/// An error of the odometry that stays the same for the whole log: what it reads too much, per unit
/// of the true motion, and the standard deviation of that estimate.
struct SystematicError {
  double value = 0.0;  ///< per unit of the true motion
  double sigma = 0.0;  ///< its standard deviation

  /// Beyond four standard deviations: chance makes less than one log in ten thousand look so. Not
  /// from 0.5 on: it would have misled the matching that it was estimated with.
  bool IsSignificant() const;
};

/// How far the clocks of odometry and laser are apart. The odometry that comes with a scan tells
/// where the robot was this long after it: positive where the wheels are ahead.
struct ClockOffset {
  double value_s = 0.0;  ///< [s]
  double sigma_s = 0.0;  ///< its standard deviation [s]; 0: unknown

  /// Beyond four standard deviations and 10 ms, which is 5 mm for a robot at 0.5 m/s.
  bool IsSignificant() const;
};

/// Growth of the random error of one quantity, forward motion [m] or turn [rad]. Errors of
/// different steps are independent: after driving d metres and turning t radians (lengths, never
/// negative) the variance is sigma_per_sqrt_m^2 d + sigma_per_sqrt_rad^2 t.
struct RandomError {
  bool estimated = false;  ///< false if there were too few spans: the sigmas are 0, not known
  int num_spans = 0;       ///< stretches of about 1 m or 1 rad that the scan matching measured
  double sigma_per_sqrt_m = 0.0;    ///< [m/sqrt(m)] or [rad/sqrt(m)]
  double sigma_per_sqrt_rad = 0.0;  ///< [m/sqrt(rad)] or [rad/sqrt(rad)]
};

/// Standard deviations of given poses whose errors are independent of each other. Poses of another
/// mapper are like that. The errors of odometry add up along the drive.
struct PoseNoise {
  double position_m = 0.0;  ///< of x and of y [m]
  double yaw_rad = 0.0;     ///< [rad]
};

/// What the scan matching says of the odometry, in the frame of the robot.
struct OdometryNoiseReport {
  /// Translation of the given odometry per unit of the true motion. 1 if it is within 20 % of 1; a
  /// larger error is a wrong unit or sign, and the other fields describe the odometry divided by
  /// it. 0 if the odometry reports no translation or contradicts the scans: it was not used.
  double gross_translation_scale = 1.0;
  ClockOffset clock_offset;             ///< the rest is of the odometry in time with the scans
  SystematicError translation_scale;    ///< [m per m]
  SystematicError rotation_scale;       ///< [rad per rad]
  SystematicError heading_drift_rad_m;  ///< turn per metre driven forward [rad/m]
  RandomError translation;              ///< of the forward motion [m]
  RandomError rotation;                 ///< of the turn [rad]
  /// Steps that odometry and matching disagree on by more than 0.2 m or 0.2 rad, and by more than
  /// six standard deviations of `motion`. A slip, a collision, or a match to the wrong place.
  int num_leaps = 0;
  /// Steps over which the odometry reported hardly any translation while the scans moved. They were
  /// predicted instead.
  int num_still_steps = 0;
  /// The random errors as noise of a single step of this log.
  MotionOptions motion;
  /// No odometry was given or used: `motion` is the noise of the predicted steps, and the errors
  /// above are not estimated.
  bool is_prediction = false;
  /// If the given poses were found to be such, and so bad that each scan was searched for around
  /// its pose; `motion` is then the noise of a step between them, and is_prediction is true.
  /// Otherwise zero.
  PoseNoise given_poses;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_ODOMETRY_REPORT_H_
