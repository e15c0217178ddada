#ifndef PLUMBLINE_SOLVERS_CALIBRATION_H_
#define PLUMBLINE_SOLVERS_CALIBRATION_H_

#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/solver_options.h"
#include "plumbline/solvers/solver_summary.h"

namespace plumbline {

/// What of the sensors is estimated along with poses and points. Each parameter has a prior about
/// the value that the graph was given with; where the data say nothing, it stays there.
struct CalibrationOptions {
  bool laser_mounting = false;  ///< robot_from_laser: x, y, yaw
  bool range_bias = false;      ///< one length on top of all readings
  bool range_scale = false;     ///< one factor on all ranges: scale (reading + bias)
  bool odometry_scale = false;  ///< one factor on all lengths that the odometry reads
  double sigma_mounting_m = 0.1;
  double sigma_mounting_rad = 0.1;
  double sigma_range_bias_m = 0.05;
  double sigma_range_scale = 0.01;
  double sigma_odometry_scale = 0.05;
  /// Gauss-Newton steps on poses and parameters together, at most; each cuts the surfaces anew.
  int max_steps = 20;

  /// Whether there is anything to estimate.
  bool IsOn() const { return laser_mounting || range_bias || range_scale || odometry_scale; }
  bool Check(std::string* error) const;
};

struct CalibratedParameter {
  std::string name;  ///< ends with the unit; factors have none
  double given = 0.0;
  double value = 0.0;
  double sigma = 0.0;  ///< standard deviation of value, poses and surfaces being unknown, too
  double prior_sigma = 0.0;

  /// Whether the data say clearly more than the prior.
  bool IsDetermined() const { return sigma <= 0.5 * prior_sigma; }
};

struct Calibration {
  std::vector<CalibratedParameter> parameters;
  int steps = 0;
  /// Whether the last step was small against the standard deviations.
  bool settled = false;
  double time_s = 0.0;  ///< without Solve
};

/// Solve, with parameters of the sensors as further unknowns. On return the graph has the corrected
/// mountings, ranges and odometry, and the poses and points that go with them; *calibration says
/// what they are. With nothing to estimate it is Solve, and *calibration is empty.
///
/// The mounting shows in how the motion of the laser goes with that of the odometry: x and y need
/// turns, yaw needs straight stretches. Scales of ranges and odometry show only against each other,
/// or against relative poses. The standard deviations take the odometry's noise from its residuals,
/// step by step independent, and that of the laser from the options.
///
/// kFailure, with the graph unchanged: whatever Solve refuses, options out of range, lasers of
/// different mountings with laser_mounting or range_scale, poses that nothing ties to a fixed one,
/// and a linear system that cannot be solved.
SolverSummary SolveWithCalibration(const SolverOptions& options,
                                   const CalibrationOptions& calibration_options, SlamGraph* graph,
                                   Calibration* calibration);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_CALIBRATION_H_
