#include "plumbline/apps/simulation/drive.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// Largest distance between poses next to a surface that are tested for contact with it: well below
// the thickness of a wall.
constexpr double kCheckSpacing = 0.02;

// How the robot rounds an inner waypoint.
struct Corner {
  double angle_rad = 0.0;
  double radius_m = 0.0;   // 0: on the spot
  double setback_m = 0.0;  // the arc begins and ends this far from the waypoint
};

Corner MakeCorner(const Eigen::Vector2d& arriving, const Eigen::Vector2d& leaving,
                  const DriveOptions& options) {
  Corner corner;
  corner.angle_rad =
      std::atan2(arriving.x() * leaving.y() - arriving.y() * leaving.x(), arriving.dot(leaving));
  const double angle = std::abs(corner.angle_rad);
  if (angle == 0.0 || angle >= options.sharp_corner_rad) return corner;
  // Each of the two corners of a leg may take half of it.
  const double room = 0.5 * std::min(arriving.norm(), leaving.norm());
  corner.setback_m = std::min(options.corner_radius_m * std::tan(0.5 * angle), room);
  corner.radius_m = corner.setback_m / std::tan(0.5 * angle);
  return corner;
}

Status TooClose(const std::string& building, std::size_t line, double robot_radius_m,
                double clearance_m, const Pose2& pose) {
  char text[160];
  std::snprintf(text, sizeof(text),
                "path: on its way here the robot, radius %.3f m, comes within %.3f m of a surface "
                "at (%.3f, %.3f)",
                robot_radius_m, clearance_m, pose.x, pose.y);
  return Status::InvalidArgument(building + ":" + std::to_string(line) + ": " + text);
}

}  // namespace

bool DriveOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(speed_m_s, 1e-3, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(turn_rate_rad_s, 1e-3, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(corner_radius_m, 0.0, 100.0);
  PLUMBLINE_CHECK_FINITE_OPTION(sharp_corner_rad, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(sharp_corner_rad, <, kPi);
  PLUMBLINE_CHECK_OPTION_WITHIN(robot_radius_m, 0.0, 10.0);
  return true;
}

Status Drive::Plan(const World& world, const DriveOptions& options, Drive* drive) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("drive: " + error);
  const std::vector<Waypoint>& path = world.building().path;
  if (path.size() < 2) {
    return Status::InvalidArgument(world.building().name + ": path: there is none to drive along");
  }
  Drive result;
  result.AppendLegs(path, options);
  PLUMBLINE_RETURN_IF_ERROR(result.CheckClearance(world, options.robot_radius_m));
  *drive = std::move(result);
  return Status::Ok();
}

double Drive::TimeAt(double path_m) const {
  double remaining = path_m;
  for (const Piece& piece : pieces_) {
    const double length = piece.speed_m_s * piece.duration_s;
    if (length > 0.0 && remaining <= length) return piece.start_s + remaining / piece.speed_m_s;
    remaining -= length;
  }
  return duration_s_;
}

Pose2 Drive::WorldFromRobot(double time_s) const {
  const auto after =
      std::upper_bound(pieces_.begin() + 1, pieces_.end(), time_s,
                       [](double time, const Piece& piece) { return time < piece.start_s; });
  const Piece& piece = *(after - 1);
  return PoseOnPiece(piece, std::min(time_s - piece.start_s, piece.duration_s));
}

void Drive::AppendLegs(const std::vector<Waypoint>& path, const DriveOptions& options) {
  const Eigen::Vector2d start = path[0].position, first_leg = path[1].position - start;
  world_from_end_ = Pose2(start.x(), start.y(), std::atan2(first_leg.y(), first_leg.x()));
  Corner before;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d leg = path[i].position - path[i - 1].position;
    Corner corner;
    if (i + 1 < path.size()) {
      corner = MakeCorner(leg, path[i + 1].position - path[i].position, options);
    }
    const double straight = leg.norm() - before.setback_m - corner.setback_m;
    Append(options.speed_m_s, 0.0, std::max(0.0, straight) / options.speed_m_s, path[i].line);
    const double angle = std::abs(corner.angle_rad);
    const double turn_rate = corner.radius_m > 0.0 ? std::min(options.turn_rate_rad_s,
                                                              options.speed_m_s / corner.radius_m)
                                                   : options.turn_rate_rad_s;
    Append(turn_rate * corner.radius_m, std::copysign(turn_rate, corner.angle_rad),
           angle / turn_rate, path[i].line);
    before = corner;
  }
}

void Drive::Append(double speed_m_s, double turn_rate_rad_s, double duration_s, std::size_t line) {
  const Piece piece{duration_s_, world_from_end_, speed_m_s, turn_rate_rad_s, duration_s, line};
  pieces_.push_back(piece);
  world_from_end_ = PoseOnPiece(piece, duration_s);
  duration_s_ += duration_s;
  length_m_ += speed_m_s * duration_s;
}

Pose2 Drive::PoseOnPiece(const Piece& piece, double time_s) {
  const double angle = piece.turn_rate_rad_s * time_s;
  if (piece.turn_rate_rad_s == 0.0) {
    return piece.world_from_start * Pose2(piece.speed_m_s * time_s, 0.0, 0.0);
  }
  const double signed_radius = piece.speed_m_s / piece.turn_rate_rad_s;
  return piece.world_from_start *
         Pose2(signed_radius * std::sin(angle), signed_radius * (1.0 - std::cos(angle)), angle);
}

Status Drive::CheckClearance(const World& world, double robot_radius_m) const {
  for (const Piece& piece : pieces_) {
    const double length = piece.speed_m_s * piece.duration_s;
    double driven = 0.0;
    while (true) {
      const double share = length > 0.0 ? driven / length : 0.0;
      const Pose2 pose = PoseOnPiece(piece, piece.duration_s * share);
      const double clearance = world.Clearance(pose.translation());
      if (clearance < robot_radius_m) {
        return TooClose(world.building().name, piece.line, robot_radius_m, clearance, pose);
      }
      if (driven == length) break;
      // No surface is too close before the robot has come nearer by what it has to spare.
      driven = std::min(driven + std::max(kCheckSpacing, clearance - robot_radius_m), length);
    }
  }
  return Status::Ok();
}

}  // namespace plumbline
