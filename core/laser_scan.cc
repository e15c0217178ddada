#include "plumbline/core/laser_scan.h"

#include <tuple>

#include "plumbline/core/input_limits.h"
#include "plumbline/core/options_check.h"

namespace plumbline {

namespace {

auto FieldsOf(const LaserModel& model) {
  const Pose2& mounting = model.robot_from_laser;
  return std::tie(model.num_beams, model.first_bearing_rad, model.bearing_step_rad,
                  model.min_range_m, model.max_range_m, model.beam_period_s, mounting.x, mounting.y,
                  mounting.yaw);
}

}  // namespace

bool LaserModel::operator==(const LaserModel& other) const {
  return FieldsOf(*this) == FieldsOf(other);
}

bool LaserModel::operator<(const LaserModel& other) const {
  return FieldsOf(*this) < FieldsOf(other);
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
