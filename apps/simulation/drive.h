#ifndef PLUMBLINE_APPS_SIMULATION_DRIVE_H_
#define PLUMBLINE_APPS_SIMULATION_DRIVE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/world.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How a robot follows its path. Speed and turn rate are from 1e-3, which takes all day, to 100;
/// curves are up to 100 m wide, and robots up to 10 m.
struct DriveOptions {
  double speed_m_s = 0.4;                     ///< on straight stretches [m/s]
  double turn_rate_rad_s = DegToRad(40.0);    ///< on the spot, and at most on curves [rad/s]
  double corner_radius_m = 0.4;               ///< of curves, where the path leaves room [m]
  double sharp_corner_rad = DegToRad(100.0);  ///< from here on it turns on the spot [rad]
  double robot_radius_m = 0.25;               ///< no surface may come closer to its centre [m]

  bool Check(std::string* error) const;
};

/// The motion of a robot along the path of a building: straight stretches joined by arcs tangent to
/// them, or by turns on the spot where the path has a sharp corner. Speed and turn rate are
/// constant on each piece.
class Drive {
 public:
  /// InvalidArgument on options out of range, and, naming file and line of the waypoint, where the
  /// robot would touch a surface; also if the building has no path.
  static Status Plan(const World& world, const DriveOptions& options, Drive* drive);

  double duration_s() const { return duration_s_; }
  double length_m() const { return length_m_; }

  /// When the robot has first driven this far, from 0 to length_m().
  double TimeAt(double path_m) const;

  /// The robot's pose `time_s` after the start, from 0 to duration_s(); yaw not wrapped.
  Pose2 WorldFromRobot(double time_s) const;

 private:
  struct Piece {
    double start_s;
    Pose2 world_from_start;
    double speed_m_s, turn_rate_rad_s, duration_s;
    std::size_t line;  // of the waypoint that the piece leads to or rounds
  };

  void Append(double speed_m_s, double turn_rate_rad_s, double duration_s, std::size_t line);
  void AppendLegs(const std::vector<Waypoint>& path, const DriveOptions& options);
  static Pose2 PoseOnPiece(const Piece& piece, double time_s);
  Status CheckClearance(const World& world, double robot_radius_m) const;

  std::vector<Piece> pieces_;
  Pose2 world_from_end_;
  double duration_s_ = 0.0, length_m_ = 0.0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_DRIVE_H_
