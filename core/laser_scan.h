#ifndef PLUMBLINE_CORE_LASER_SCAN_H_
#define PLUMBLINE_CORE_LASER_SCAN_H_

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Geometry of a planar laser scanner: beam i leaves the laser at bearing
/// first_bearing_rad + i * bearing_step_rad, counted from the laser's x axis, counter-clockwise.
struct LaserModel {
  int num_beams = 0;               ///< at least 1
  double first_bearing_rad = 0.0;  ///< of beam 0
  double bearing_step_rad = 0.0;   ///< from a beam to the next; negative: clockwise
  /// A reading counts as a return if min_range_m <= reading < max_range_m; all else (NaN and
  /// infinity included) is "no return".
  double min_range_m = 0.05;
  double max_range_m = 80.0;  ///< see min_range_m
  /// From a beam to the next [s]: beam i is measured i * beam_period_s after the time of the scan.
  /// 0: all beams at once.
  double beam_period_s = 0.0;
  /// Mounting of the laser on the robot.
  Pose2 robot_from_laser;

  /// Bearing [rad] of a beam, from the laser's x axis, counter-clockwise.
  double Bearing(int beam) const { return first_bearing_rad + beam * bearing_step_rad; }
  /// Whether a reading [m] is one of a surface.
  bool IsReturn(double range_m) const { return range_m >= min_range_m && range_m < max_range_m; }

  /// Whether all fields are the same.
  bool operator==(const LaserModel& other) const;
  /// Some order of all models, for sorted containers.
  bool operator<(const LaserModel& other) const;
  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// When the beams of a sweep are measured.
enum class SweepOrder {
  kFirstBeamFirst,  ///< as LaserModel::beam_period_s says
  kLastBeamFirst,  ///< at the same pace against their order: drivers turn the array of a laser that
                   ///< runs clockwise, and leave its times
  kAtOnce,
};
const char* ToString(SweepOrder order);

/// One sweep of a laser: `ranges` [m], one entry per beam of its LaserModel.
struct LaserScan {
  double timestamp_s = 0.0;    ///< [s]
  std::vector<double> ranges;  ///< [m]
};

/// The point [m], in the frame of the laser, where a beam of this bearing and range ends.
inline Eigen::Vector2d BeamEnd(double range_m, double bearing_rad) {
  return {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad)};
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_LASER_SCAN_H_
