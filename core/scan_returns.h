#ifndef PLUMBLINE_CORE_SCAN_RETURNS_H_
#define PLUMBLINE_CORE_SCAN_RETURNS_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose_frame.h"

namespace plumbline {

/// A laser, and what all its sweeps share.
struct LaserBeams {
  LaserModel model;                         ///< as it was given
  std::vector<Eigen::Vector2d> directions;  ///< unit vector per beam, in the frame of the laser
  std::vector<Eigen::Vector2d> directions_in_robot;  ///< the same in the frame of the robot

  LaserBeams() = default;
  /// Finds the directions.
  explicit LaserBeams(const LaserModel& laser);
};

/// The returns of one sweep, by their ids. SlamGraph says the same of any return, but has to find
/// its sweep each time. Valid until the graph changes.
class ScanReturns {
 public:
  /// Beams are kept in 16 bits. As the returns of a sweep are in order of their beams, it is enough
  /// to know from which return on these are larger.
  static constexpr int kSmallBeams = 1 << 16;

  /// The arrays of a graph: of all returns, but off_beam_rad, of the sweep's returns, null if these
  /// lie on their beams. first_large_beam: the first return of a beam beyond kSmallBeams.
  ScanReturns(const LaserBeams& laser, const float* range_m, const std::uint16_t* low_beam,
              const float* off_beam_rad, std::size_t first_return, std::size_t first_large_beam)
      : model_(&laser.model),
        directions_(laser.directions.data()),
        directions_in_robot_(laser.directions_in_robot.data()),
        laser_in_robot_(laser.model.robot_from_laser.translation()),
        range_m_(range_m),
        low_beam_(low_beam),
        off_beam_rad_(off_beam_rad),
        first_return_(first_return),
        first_large_beam_(first_large_beam) {}

  /// Index of the beam within its sweep.
  int Beam(std::size_t return_id) const {
    return low_beam_[return_id] + (return_id < first_large_beam_ ? 0 : kSmallBeams);
  }
  /// Direction of the beam [rad] in the frame of its laser, counter-clockwise from the x axis.
  double Bearing(std::size_t return_id) const {
    const double by_model = model_->Bearing(Beam(return_id));
    return off_beam_rad_ == nullptr ? by_model : by_model + OffBeam(return_id);
  }
  /// Measured length of the beam [m].
  double Range(std::size_t return_id) const { return range_m_[return_id]; }
  /// Direction of the beam, a unit vector in the frame of its laser.
  Eigen::Vector2d DirectionInLaser(std::size_t return_id) const {
    return OnBeam(directions_[Beam(return_id)], return_id);
  }
  /// The same in the frame of its robot.
  Eigen::Vector2d DirectionInRobot(std::size_t return_id) const {
    return OnBeam(directions_in_robot_[Beam(return_id)], return_id);
  }
  /// Position of the laser [m] in the frame of its robot.
  const Eigen::Vector2d& laser_in_robot() const { return laser_in_robot_; }
  /// Measured end of the beam [m] in the frame of its laser.
  Eigen::Vector2d PointInLaser(std::size_t return_id) const {
    return Range(return_id) * DirectionInLaser(return_id);
  }
  /// Measured end of the beam [m] in the frame of its robot.
  Eigen::Vector2d PointInRobot(std::size_t return_id) const {
    return Range(return_id) * DirectionInRobot(return_id) + laser_in_robot_;
  }

 private:
  // Sines and cosines would be most of the work of placing a map.
  Eigen::Vector2d OnBeam(const Eigen::Vector2d& direction, std::size_t return_id) const {
    if (off_beam_rad_ == nullptr) return direction;
    return Turned(direction, OffBeam(return_id));
  }
  double OffBeam(std::size_t return_id) const { return off_beam_rad_[return_id - first_return_]; }

  const LaserModel* model_;
  const Eigen::Vector2d* directions_;
  const Eigen::Vector2d* directions_in_robot_;
  Eigen::Vector2d laser_in_robot_;
  const float* range_m_;
  const std::uint16_t* low_beam_;
  const float* off_beam_rad_;
  std::size_t first_return_;
  std::size_t first_large_beam_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_SCAN_RETURNS_H_
