#include "plumbline/apps/io/ros_mounting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// Beyond this the cut through the building is no longer the one at the laser's height.
constexpr double kMaxTiltRad = DegToRad(3.0);

// Candidates that are tried: as many scans may be bad.
std::size_t CountOthers(const std::vector<std::optional<LaserPlace>>& places,
                        const LaserPlace& place, std::size_t limit) {
  std::size_t num_others = 0;
  for (const std::optional<LaserPlace>& other : places) {
    if (other && !other->IsNear(place) && ++num_others > limit) break;
  }
  return num_others;
}

// The first place that most others agree with, or else the first one; empty if there is none.
std::optional<LaserPlace> UsualPlace(const std::vector<std::optional<LaserPlace>>& places) {
  const std::size_t limit = std::min(BadRecordLimits().Of(places.size()), places.size() / 2);
  std::optional<LaserPlace> first;
  std::size_t num_tried = 0;
  for (const std::optional<LaserPlace>& place : places) {
    if (!place) continue;
    if (!first) first = place;
    if (num_tried++ > limit) break;
    if (CountOthers(places, *place, limit) <= limit) return place;
  }
  return first;
}

}  // namespace

bool AreAtRest(const Pose2& before, const Pose2& after) {
  constexpr double kRestM = 0.01, kRestRad = 0.01;
  const Pose2 change = Between(before, after);
  return change.translation().norm() <= kRestM && std::abs(change.yaw) <= kRestRad;
}

bool LaserPlace::IsNear(const LaserPlace& other) const {
  return upside_down == other.upside_down && AreAtRest(robot_from_laser, other.robot_from_laser);
}

Status FindLaserPlace(const TransformTree& transforms, const std::string& robot_frame,
                      const std::string& laser_frame, const std::vector<double>& times_s,
                      LaserPlaces* places) {
  LaserPlaces result;
  result.faults.resize(times_s.size());
  result.kinds.resize(times_s.size());
  std::optional<TransformPath> path;
  PLUMBLINE_RETURN_IF_ERROR(transforms.FindPath(robot_frame, laser_frame, &path));
  if (!path) {
    *places = std::move(result);
    return Status::Ok();
  }
  result.is_known = true;
  result.bad_samples = transforms.BadSamplesText(*path);
  std::vector<std::optional<LaserPlace>> at_times(times_s.size());
  const std::string laser = "the laser's frame '" + laser_frame + "' ";
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const Eigen::Isometry3d robot_from_laser = transforms.At(*path, times_s[i]);
    const double upright = robot_from_laser.linear()(2, 2);
    if (std::abs(upright) >= std::cos(kMaxTiltRad)) {
      at_times[i] = LaserPlace{InPlane(robot_from_laser), upright < 0.0};
      continue;
    }
    result.kinds[i] = "the laser is tilted";
    result.faults[i] = laser + "is tilted by " +
                       std::to_string(RadToDeg(std::acos(std::abs(upright)))) + " deg in '" +
                       robot_frame + "': its sweeps are no horizontal cuts";
  }
  const std::optional<LaserPlace> usual = UsualPlace(at_times);
  if (usual) result.place = *usual;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!at_times[i] || at_times[i]->IsNear(result.place)) continue;
    result.kinds[i] = "the laser has moved on the robot";
    result.faults[i] =
        laser + "has moved on the robot, '" + robot_frame + "': one at rest is expected";
  }
  *places = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
