#include "plumbline/apps/live/live_scan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "plumbline/apps/io/ros_scans.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr double kNoReturnM = std::numeric_limits<double>::infinity();

// A scan whose time_increment makes no sweep of up to this [s] is taken as one instant.
constexpr double kMaxLiveSweepS = 1.0;
// Longer ranges are not stated, but FLT_MAX or the like [m].
constexpr double kLongestRangeM = 1e5;

double BeamPeriodOf(const RosScan& scan) {
  const double sweep_s = scan.time_increment_s * static_cast<double>(scan.ranges.size());
  return sweep_s > 0.0 && sweep_s <= kMaxLiveSweepS ? scan.time_increment_s : 0.0;
}

// Bearings that differ by less than a tenth of a step are the same.
bool HaveSameBeams(const LaserModel& a, const LaserModel& b) {
  const double tolerance = 0.1 * std::abs(a.bearing_step_rad);
  return a.num_beams == b.num_beams &&
         std::abs(a.first_bearing_rad - b.first_bearing_rad) <= tolerance &&
         std::abs(a.bearing_step_rad - b.bearing_step_rad) * a.num_beams <= tolerance;
}

}  // namespace

LaserModel LaserOf(const RosScan& scan, const LaserPlace& place) {
  LaserModel laser;
  const double sign = place.upside_down ? -1.0 : 1.0;
  const BeamAngles angles = AnglesOf(scan, BeamAngleSource::kAngleMax);
  laser.num_beams = NumBeams(scan);
  laser.first_bearing_rad = sign * angles.first_rad;
  laser.bearing_step_rad = sign * angles.step_rad;
  laser.min_range_m = std::max(laser.min_range_m, scan.range_min_m);
  if (scan.range_max_m > laser.min_range_m && scan.range_max_m <= kLongestRangeM) {
    laser.max_range_m = scan.range_max_m;
  }
  laser.beam_period_s = BeamPeriodOf(scan);
  laser.robot_from_laser = place.robot_from_laser;
  return laser;
}

std::vector<double> RangesFor(const LaserModel& laser, const LaserPlace& place, const RosScan& scan,
                              bool* is_resampled) {
  const LaserModel own = LaserOf(scan, place);
  *is_resampled = !HaveSameBeams(laser, own);
  if (!*is_resampled) return scan.ranges;
  std::vector<double> ranges(laser.num_beams, kNoReturnM);
  std::vector<double> offsets(laser.num_beams, 0.5 + 1e-6);  // [steps]
  int num_found = 0;
  const int middle = laser.num_beams / 2;
  for (int i = 0; i < own.num_beams; ++i) {
    const double turn = NormalizeAngle(own.Bearing(i) - laser.Bearing(middle));
    const double beam = middle + turn / laser.bearing_step_rad;
    const double nearest = std::round(beam);
    if (nearest < 0.0 || nearest >= laser.num_beams) continue;
    ++num_found;
    const auto index = static_cast<std::size_t>(nearest);
    const double offset = std::abs(beam - nearest);
    if (offset >= offsets[index]) continue;
    offsets[index] = offset;
    ranges[index] = scan.ranges[i];
  }
  if (2 * num_found < own.num_beams) ranges.clear();
  return ranges;
}

}  // namespace plumbline
