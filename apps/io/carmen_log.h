#ifndef PLUMBLINE_APPS_IO_CARMEN_LOG_H_
#define PLUMBLINE_APPS_IO_CARMEN_LOG_H_

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plumbline/apps/io/bad_records.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// One FLASER or ROBOTLASER1 record.
struct CarmenScan {
  double timestamp_s = 0.0;    ///< ipc_timestamp
  Pose2 odom_from_laser;       ///< first triple of the record
  Pose2 odom_from_robot;       ///< second triple
  std::vector<double> ranges;  ///< [m], one per beam; a NaN or infinity is "no return"
  double first_bearing_rad = 0.0;
  double bearing_step_rad = 0.0;
  double max_range_m = 0.0;  ///< readings from here on are "no return", see ReadCarmenLog
  bool is_flaser = false;    ///< whose record does not state its bearings
  std::size_t line = 0;      ///< in the file, from 1
};

/// A record that could not be read.
struct CarmenIssue {
  std::size_t line = 0;
  std::string field;
  std::string message;  ///< e.g. "x.log:17: FLASER field 'odom_x': 'abc' is not a number"
};

struct CarmenLog {
  /// By time, records of equal time in the file's order; all in that order if the clock is useless
  /// (see ClockFault).
  std::vector<CarmenScan> scans;
  std::map<std::string, std::string> params;  ///< first word of the value; the last record wins
  /// From the first beam of a sweep to the last [s]. Logs do not say it: 0 when read.
  double sweep_time_s = 0.0;
  std::optional<double> no_return_level_m;  ///< see FindNoReturnLevel

  std::size_t num_records = 0;  ///< FLASER, ROBOTLASER1, ODOM and PARAM lines, unreadable ones too
  std::size_t num_issues = 0;   ///< unreadable records, plus one if a compressed file lacks its end
  std::vector<CarmenIssue> issues;  ///< the first 10 of them
  /// Scans older than the one before them: where a clock jumped back or the logger lagged. Sorting
  /// has put them in place. None if the clock is useless.
  std::size_t num_out_of_order = 0;
};

/// Number of unreadable records that a log may have, and its size.
struct CarmenReadOptions {
  BadRecordLimits bad_records;
  /// From the first beam of a FLASER record to the last [rad]; empty: see ReadCarmenLog.
  std::optional<double> flaser_fov_rad;
  /// What its scans and parameters may take, a graph made of them included [bytes]; 0: no limit.
  double max_bytes = 0.0;

  bool Check(std::string* error) const;
};

/// Bearings [rad] of the first beam of a FLASER record and from a beam to the next, as
/// ReadCarmenLog takes them.
void SetFlaserBearings(int num_beams, const std::optional<double>& fov_rad, double* first_rad,
                       double* step_rad);

/// Reads a log of the CARMEN toolkit, plain or gzip-compressed. Records (blank-separated):
///
///   FLASER n r1..rn  laser_x y theta  odom_x y theta  ipc_timestamp host logger_timestamp
///   ROBOTLASER1 laser_type start_angle fov angular_resolution max_range accuracy remission_mode
///     n r1..rn m rem1..remm  laser_x y theta  robot_x y theta  laser_tv laser_rv forward_safety
///     side_safety turn_axis  ipc_timestamp host logger_timestamp
///   ODOM x y theta tv rv accel  ipc_timestamp host logger_timestamp
///   PARAM name value ...
///
/// ODOM records are checked, but not kept: every scan has its own odometry. Comments (#) and other
/// keywords are skipped. Units: m, rad, s.
///
/// Bearings: ROBOTLASER1 states them. FLASER covers 180 deg from -90 deg on; an odd n (181, 361)
/// has a beam at both ends, step 180/(n-1) deg, an even n (180, 360) leaves the last one out, step
/// 180/n deg. Lasers of 541 and 1081 beams cover 270 deg. With
/// options.flaser_fov_rad, the beams of every FLASER cover that much, symmetrically; of a full turn
/// the last beam is left out.
///
/// Maximum range: what ROBOTLASER1 states, or PARAM robot_front_laser_max for FLASER, or the level
/// that FindNoReturnLevel finds below that. With none of the three sources it is 80 m.
///
/// An unreadable record (number of fields, text for a number, a pose or time that is not finite or
/// beyond core/input_limits.h, no beams) is skipped and reported. A compressed file that is
/// truncated yields its whole lines and one more issue.
///
/// NotFound or InvalidArgument if the file cannot be opened or read, DataLoss on a corrupt
/// compressed file or more unreadable records than the options allow, InvalidArgument if no scan is
/// left, a line is too long or the log takes too much memory; `log` is then untouched.
Status ReadCarmenLog(const std::string& path, const CarmenReadOptions& options, CarmenLog* log);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_CARMEN_LOG_H_
