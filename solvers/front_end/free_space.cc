#include "plumbline/solvers/front_end/free_space.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose_frame.h"

namespace plumbline {
namespace {

// Least distance [m] of a return from the surface behind it, to be in the viewer's free space: more
// than a pose that is a little off, or a beam that meets a wall at a flat angle, can explain. Tuned
// on fr079, intel and simulated buildings.
constexpr double kMarginM = 0.3;
constexpr double kMarginPerRange = 0.02;
// Angle between returns that are compared, so that lasers of many and of few beams have as much
// evidence. A laser of fewer beams has all of them compared.
constexpr double kReturnSpacingRad = DegToRad(1.0);
constexpr int kNumNeighbours = 4;

// Bearing [rad] of a point, to 2e-8, in half the time of std::atan2. Source: Abramowitz, Stegun:
// Handbook of mathematical functions (1964), 4.4.49.
double BearingOf(const Eigen::Vector2d& point) {
  const double x = std::abs(point.x()), y = std::abs(point.y());
  const double larger = std::max(x, y);
  if (!(larger > 0.0)) return 0.0;
  const double tangent = std::min(x, y) / larger, s = tangent * tangent;
  const double high =
      s * (-0.0752896400 + s * (0.0429096138 + s * (-0.0161657367 + s * 0.0028662257)));
  double angle =
      tangent * (1.0 + s * (-0.3333314528 +
                            s * (0.1999355085 + s * (-0.1420889944 + s * (0.1065626393 + high)))));
  if (y > x) angle = 0.5 * kPi - angle;
  if (point.x() < 0.0) angle = kPi - angle;
  return std::copysign(angle, point.y());
}

}  // namespace

std::size_t FreeSpaceScan::StrideOf(const LaserModel& laser) {
  const double beams_per_rad = 1.0 / std::abs(laser.bearing_step_rad);
  const double num_beams = std::round(beams_per_rad * kReturnSpacingRad);
  return static_cast<std::size_t>(std::clamp(num_beams, 1.0, 1.0 * laser.num_beams));
}

FreeSpaceScan::FreeSpaceScan(const SlamGraph& graph, int scan)
    : laser_(graph.LaserOfScan(scan)),
      first_bearing_rad_(NormalizeAngle(laser_.first_bearing_rad)),
      turn_direction_(laser_.bearing_step_rad < 0.0 ? -1.0 : 1.0),
      beams_per_rad_(1.0 / std::abs(laser_.bearing_step_rad)) {
  const ScanEntry& entry = graph.scan(scan);
  const ScanReturns returns = graph.ReturnsOfScan(scan);
  const std::vector<double> range_of_beam = graph.RangesOfScan(scan, 0.0);
  const std::size_t stride = StrideOf(laser_);
  points_in_robot_.reserve((entry.num_returns + stride - 1) / stride);
  std::vector<int> moving;
  for (std::size_t k = 0; k < entry.num_returns; k += stride) {
    const std::size_t r = entry.first_return + k;
    if (graph.Moves(r)) moving.push_back(static_cast<int>(points_in_robot_.size()));
    points_in_robot_.push_back(returns.PointInRobot(r));
  }
  MarkMoving(moving);
  shortest_range_.reserve(std::max(0, laser_.num_beams + 1 - kNumNeighbours));
  for (int first = 0; first + kNumNeighbours <= laser_.num_beams; ++first) {
    const auto begin = range_of_beam.begin() + first;
    shortest_range_.push_back(static_cast<float>(*std::min_element(begin, begin + kNumNeighbours)));
  }
}

// The shortest of the four beams next to a bearing, 0 if one of them has no return.
double FreeSpaceScan::ShortestRange(double bearing_rad) const {
  double from_first_rad = turn_direction_ * (bearing_rad - first_bearing_rad_);
  if (from_first_rad < 0.0) from_first_rad += 2.0 * kPi;
  // Not an int yet: a turn may have any number of steps.
  const double beam = from_first_rad * beams_per_rad_;
  constexpr int kNumBefore = kNumNeighbours / 2 - 1;
  const bool is_seen =
      beam >= kNumBefore && beam < static_cast<double>(shortest_range_.size() + kNumBefore);
  return is_seen ? shortest_range_[static_cast<std::size_t>(beam) - kNumBefore] : 0.0;
}

FreeSpaceConflict FreeSpaceScan::Compare(const FreeSpaceScan& other, const Pose2& robot_from_other,
                                         ComparedReturns* details) const {
  FreeSpaceConflict at_rest, moving;
  const std::size_t num_returns = other.points_in_robot_.size();
  if (details != nullptr) details->verdicts.assign(num_returns, ReturnVerdict::kNotCompared);
  const Pose2 laser_from_other = laser_.robot_from_laser.Inverse() * robot_from_other;
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(laser_from_other.yaw).toRotationMatrix();
  for (std::size_t i = 0; i < num_returns; ++i) {
    const Eigen::Vector2d point =
        rotation * other.points_in_robot_[i] + laser_from_other.translation();
    const double range = point.norm();
    const double shortest = ShortestRange(BearingOf(point));
    const double margin = kMarginM + kMarginPerRange * range;
    if (shortest <= 0.0 || range > shortest + margin) continue;  // not seen, or hidden
    const bool conflicts = range < shortest - margin;
    (other.Moves(i) ? moving : at_rest) += {1, conflicts ? 1 : 0};
    if (details != nullptr && !other.Moves(i)) {
      details->verdicts[i] = conflicts ? ReturnVerdict::kConflicts : ReturnVerdict::kAgrees;
    }
  }
  if (details != nullptr) {
    details->with_moving = at_rest;
    details->with_moving += moving;
  }
  return at_rest;
}

void FreeSpaceScan::MarkMoving(const std::vector<int>& returns) {
  if (!returns.empty()) moves_.resize(points_in_robot_.size(), 0);
  for (const int place : returns) moves_[place] = 1;
}

FreeSpaceConflict CompareBothWays(const FreeSpaceScan& a, const FreeSpaceScan& b,
                                  const Pose2& a_from_b) {
  FreeSpaceConflict conflict = a.Compare(b, a_from_b, nullptr);
  conflict += b.Compare(a, a_from_b.Inverse(), nullptr);
  return conflict;
}

}  // namespace plumbline
