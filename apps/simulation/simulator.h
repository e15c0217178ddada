#ifndef PLUMBLINE_APPS_SIMULATION_SIMULATOR_H_
#define PLUMBLINE_APPS_SIMULATION_SIMULATOR_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/drive.h"
#include "plumbline/apps/simulation/traffic.h"
#include "plumbline/apps/simulation/world.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Noise of a laser reading, up to 10 m and 1 rad: what is further off is no laser. Defaults: SICK
/// LMS class.
struct LaserNoise {
  double sigma_range_m = 0.012;              ///< along the beam [m]
  double sigma_bearing_rad = DegToRad(0.1);  ///< of the direction in which a beam leaves [rad]
  double no_return_probability = 0.002;      ///< of a beam that is lost (glass, black surface)
  double short_reading_probability = 0.001;  ///< of something in the way (people), anywhere
                                             ///< between the laser and the surface

  bool Check(std::string* error) const;
};

/// Noise of the odometry step from one scan to the next, which reads: turn by rot1, drive trans,
/// turn by rot2 (Thrun, Burgard, Fox: Probabilistic Robotics, ch. 5.4). Standard deviations grow
/// with what was driven; on top come two errors that stay the same for the whole drive. Each is up
/// to 100, a hundred times the motion.
struct OdometryNoise {
  double rotation_per_rotation = 0.03;            ///< alpha_1 [rad per rad]
  double rotation_per_translation_rad_m = 0.03;   ///< alpha_2 [rad per m]
  double translation_per_translation = 0.03;      ///< alpha_3 [m per m]
  double translation_per_rotation_m_rad = 0.005;  ///< alpha_4 [m per rad]
  double heading_drift_rad_m = 0.003;             ///< wheels of unequal size [rad per m driven]
  double scale_error = 0.01;                      ///< wheels of the wrong size [m per m driven]

  bool Check(std::string* error) const;
};

/// All errors of an odometry times a factor >= 0.
OdometryNoise Scaled(const OdometryNoise& noise, double factor);

/// Something that goes wrong once; a distance of 0 changes nothing.
struct DriveFault {
  double at_path_m = 0.0;   ///< where on the path, counted from its start [m]
  double distance_m = 0.0;  ///< [m]; both up to 1e5, as far as a building reaches

  bool Check(std::string* error) const;
};

/// Times are up to 1e5 s, a day of driving, and directions up to a full turn either way.
struct SimulationOptions {
  /// By default 360 beams over 180 deg, like CARMEN's front laser. Its beam_period_s makes it sweep
  /// while the robot drives on.
  LaserModel laser;
  double scan_period_s = 0.3;  ///< from one scan to the next [s], from 1 ms to an hour
  DriveOptions drive;
  LaserNoise laser_noise;
  OdometryNoise odometry_noise;
  TrafficOptions traffic;
  /// The robot is carried, or slides, along its path, at most to its end. The wheels do not notice.
  DriveFault carry;
  /// How long that takes, during which nothing is recorded [s]; 0: it happens between two scans.
  double carry_duration_s = 0.0;
  /// The odometry leaps in this direction, seen from the robot [rad], although the robot does not.
  DriveFault odometry_leap;
  double odometry_leap_direction_rad = 0.0;
  /// The leap is spread evenly over this time [s], like the slip of a wheel; 0: it is at once.
  double odometry_leap_duration_s = 0.0;
  /// The clocks of wheels and laser disagree: a scan comes with the odometry of this much earlier,
  /// or later where negative, at most with that of the start and of the end [s].
  double odometry_delay_s = 0.0;
  /// The laser is really mounted at laser.robot_from_laser times this, which nobody knows; up to
  /// 100 m off.
  Pose2 mounting_error;
  std::uint64_t seed = 1;

  SimulationOptions();
  bool Check(std::string* error) const;
};

/// A scan and the truth about it.
struct SimulatedScan {
  /// Ranges rounded to mm, as a log holds them; a beam without a return reads max_range_m.
  LaserScan scan;
  Pose2 world_from_robot;  ///< true pose at its time; yaw in [-pi, pi)
  /// Pose by odometry; at the first scan the true one, of the time that the odometry is of.
  Pose2 odom_from_robot;
  /// Point [m, world frame] on the surface that each beam measured. NaN if it has no return, or one
  /// from something that does not belong to the building.
  std::vector<Eigen::Vector2d> hits;
};

struct SimulatedLog {
  LaserModel laser;
  std::vector<SimulatedScan> scans;  ///< in order of time, which starts at 0
  double path_length_m = 0.0;        ///< driven from start to end, not carried
};

/// Drives a robot along the path of a building and records what its laser and wheels report. The
/// same options give the same log; the odometry depends neither on the laser nor on the traffic.
/// Time goes on while nothing is recorded.
/// InvalidArgument on options out of range, where Drive::Plan fails and beyond 4e8 readings; `log`
/// is then untouched.
Status Simulate(const World& world, const SimulationOptions& options, SimulatedLog* log);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_SIMULATOR_H_
