#include "plumbline/core/laser_scan.h"

#include "plumbline/core/input_limits.h"
#include "plumbline/core/options_check.h"

namespace plumbline {

bool LaserModel::operator==(const LaserModel& other) const {
  return num_beams == other.num_beams && first_bearing_rad == other.first_bearing_rad &&
         bearing_step_rad == other.bearing_step_rad && min_range_m == other.min_range_m &&
         max_range_m == other.max_range_m && beam_period_s == other.beam_period_s &&
         robot_from_laser.x == other.robot_from_laser.x &&
         robot_from_laser.y == other.robot_from_laser.y &&
         robot_from_laser.yaw == other.robot_from_laser.yaw;
}

bool LaserModel::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(num_beams, >, 0);
  PLUMBLINE_CHECK_OPTION(num_beams, <=, 100000);  // three times the finest there are, and fast
  PLUMBLINE_CHECK_FINITE_OPTION(first_bearing_rad, >=, -2.0 * kPi);
  PLUMBLINE_CHECK_FINITE_OPTION(first_bearing_rad, <=, 2.0 * kPi);
  PLUMBLINE_CHECK_FINITE_OPTION(std::abs(bearing_step_rad), >=, 0.0);
  if (num_beams > 1) {
    PLUMBLINE_CHECK_OPTION(std::abs(bearing_step_rad), >, 0.0);
    PLUMBLINE_CHECK_OPTION(std::abs(bearing_step_rad), <=, kPi);
  }
  PLUMBLINE_CHECK_FINITE_OPTION(min_range_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(max_range_m, >, min_range_m);
  PLUMBLINE_CHECK_OPTION(max_range_m, <=, 1e5);
  // Slower than once a minute is no sweep.
  PLUMBLINE_CHECK_OPTION_WITHIN(beam_period_s * num_beams, 0.0, 60.0);
  if (!IsWithinLimits(robot_from_laser)) {
    if (error != nullptr) *error = "robot_from_laser is not finite, or beyond all limits";
    return false;
  }
  return true;
}

const char* ToString(SweepOrder order) {
  switch (order) {
    case SweepOrder::kFirstBeamFirst:
      return "first beam first";
    case SweepOrder::kLastBeamFirst:
      return "last beam first";
    case SweepOrder::kAtOnce:
      return "at once";
  }
  return "?";
}

}  // namespace plumbline
