#include "plumbline/solvers/seeding/free_space.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// A return must be this much in front of what the viewer saw to be in its free space: more than a
// pose that is a little off, or a beam that meets a wall at a flat angle, can explain.
constexpr double kMarginM = 0.3;
constexpr double kMarginPerRange = 0.02;
constexpr std::size_t kReturnStride = 2;

// The shortest of the four beams next to a bearing, 0 if one of them has no return.
double ShortestRange(const LaserModel& laser, const std::vector<double>& range_of_beam,
                     double bearing_rad) {
  if (laser.num_beams < 4) return 0.0;
  // In beams from the first one, on the turn that the sweep is on.
  const double turn = 2.0 * kPi / std::abs(laser.bearing_step_rad);
  double beam = (bearing_rad - laser.first_bearing_rad) / laser.bearing_step_rad;
  beam -= turn * std::floor(beam / turn);
  const int first = static_cast<int>(std::floor(beam)) - 1;
  if (first < 0 || first + 3 >= laser.num_beams) return 0.0;
  return *std::min_element(range_of_beam.begin() + first, range_of_beam.begin() + first + 4);
}

}  // namespace

FreeSpaceConflict CompareFreeSpace(const SlamGraph& graph, int viewer, int scan,
                                   const Pose2& viewer_from_scan) {
  const LaserModel& laser = graph.LaserOfScan(viewer);
  const ScanEntry& seen = graph.scan(viewer);
  std::vector<double> range_of_beam(laser.num_beams, 0.0);
  for (std::size_t r = seen.first_return; r < seen.first_return + seen.num_returns; ++r) {
    range_of_beam[graph.returns().beam[r]] = graph.returns().range_m[r];
  }
  const Pose2 laser_from_scan = laser.robot_from_laser.Inverse() * viewer_from_scan;
  const ScanEntry& entry = graph.scan(scan);
  FreeSpaceConflict conflict;
  for (std::size_t k = 0; k < entry.num_returns; k += kReturnStride) {
    const Eigen::Vector2d point = laser_from_scan * graph.PointInRobot(entry.first_return + k);
    const double range = point.norm();
    const double bearing = std::atan2(point.y(), point.x());
    const double shortest = ShortestRange(laser, range_of_beam, bearing);
    const double margin = kMarginM + kMarginPerRange * range;
    if (shortest <= 0.0 || range > shortest + margin) continue;  // not seen, or hidden
    ++conflict.num_compared;
    if (range < shortest - margin) ++conflict.num_conflicting;
  }
  return conflict;
}

}  // namespace plumbline
