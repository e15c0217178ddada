#ifndef PLUMBLINE_SOLVERS_CALIBRATION_H_
#define PLUMBLINE_SOLVERS_CALIBRATION_H_

#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

/// What of the sensors is estimated along with poses and points. Each parameter has a prior about
/// the value that the graph was given with; where the data say nothing, it stays there.
struct CalibrationOptions {
  bool laser_mounting = false;  ///< robot_from_laser: x, y, yaw; prior: 0.1 m, 0.1 rad
  bool range_bias = false;      ///< one length on top of all readings; prior: 0.05 m
  /// One factor on all ranges: scale (reading + bias); prior: 1 %.
  bool range_scale = false;
  /// One factor on all lengths that the odometry reads; prior: 5 %.
  bool odometry_scale = false;

  /// Whether there is anything to estimate.
  bool IsOn() const { return laser_mounting || range_bias || range_scale || odometry_scale; }
};

/// One parameter of the sensors, after the fact. In m or rad, factors without unit.
struct CalibratedParameter {
  std::string name;          ///< ends with the unit; factors have none
  double given = 0.0;        ///< before
  double value = 0.0;        ///< after
  double sigma = 0.0;        ///< standard deviation of value, poses and surfaces being unknown, too
  double prior_sigma = 0.0;  ///< as CalibrationOptions had it

  /// Whether the data say clearly more than the prior.
  bool IsDetermined() const { return sigma <= 0.5 * prior_sigma; }
};

/// What SolveWithCalibration found of the sensors.
struct Calibration {
  std::vector<CalibratedParameter> parameters;  ///< those that were asked for
  int steps = 0;                                ///< of Gauss-Newton
  /// Whether the last step was small against the standard deviations.
  bool settled = false;
  double time_s = 0.0;  ///< without Solve
  /// What the graph's measurements should have been: SlamGraph::Corrected applies it.
  MeasurementCorrections corrections;
};

/// Solve, with parameters of the sensors as further unknowns; as there, the given state needs no
/// points. On return *state has the poses and
/// points that go with the corrected mountings, ranges and odometry; *calibration says what these
/// are. With nothing to estimate it is Solve, and *calibration is empty.
///
/// The callback sees the steps on the parameters, too, as phase "sensors". If it stops one, the
/// parameters stay as they are and Solve takes one step without asking again: kUserStopped.
///
/// The mounting shows in how the motion of the laser goes with that of the odometry: x and y need
/// turns, yaw needs straight stretches. Scales of ranges and odometry show only against each other,
/// or against relative poses. The standard deviations take the odometry's noise from its residuals,
/// step by step independent, and that of the laser from the options.
///
/// Corrections, of factors their logarithms, are multiples of 1e-7. Collective for a shared graph.
///
/// kFailure, with the state unchanged: whatever Solve refuses, options out of range, lasers of
/// different mountings or several fixed poses with laser_mounting or range_scale, poses that
/// nothing ties to a fixed one, a linear system that cannot be solved, and a callback that throws.
SolverSummary SolveWithCalibration(const SolverOptions& options,
                                   const CalibrationOptions& calibration_options,
                                   const SlamGraph& graph, MapState* state,
                                   Calibration* calibration);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_CALIBRATION_H_
