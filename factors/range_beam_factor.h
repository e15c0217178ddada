#ifndef PLUMBLINE_FACTORS_RANGE_BEAM_FACTOR_H_
#define PLUMBLINE_FACTORS_RANGE_BEAM_FACTOR_H_

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/factors/analytic_factor_forward.h"

namespace plumbline {

/// What all beams of one sweep share: world_from_laser, and the vector from the robot's origin to
/// the laser in the world frame, which carries a turn of the robot to the laser.
struct BeamFrame {
  double x = 0.0, y = 0.0;  ///< position of the laser in the world [m]
  double cos_yaw = 1.0, sin_yaw = 0.0;
  double lever_x = 0.0, lever_y = 0.0;  ///< [m]
};

inline BeamFrame MakeBeamFrame(const double* world_from_robot, const Pose2& robot_from_laser) {
  const Pose2 world_from_laser = Pose2(world_from_robot) * robot_from_laser;
  return {world_from_laser.x,
          world_from_laser.y,
          std::cos(world_from_laser.yaw),
          std::sin(world_from_laser.yaw),
          world_from_laser.x - world_from_robot[0],
          world_from_laser.y - world_from_robot[1]};
}

/// One laser return, as a residual between the pose of the robot and the map point m it hit:
///   q = laser_from_world m,
///   residual = [ (|q| - range) / sigma_range ; wrap(atan2(q_y, q_x) - bearing) / sigma_bearing ].
/// Pose: x, y [m], yaw [rad] of world_from_robot; point: x, y [m] in the world; beam: unit vector
/// of the bearing. Residual: 2, dimensionless. d_pose is 2x3, d_point 2x2, row-major, each may be
/// null. Singular at |q| = 0; the second residual jumps where the bearing error crosses +-pi.
///
/// Returns false if |q| = 0 or anything is not finite; the outputs then carry no meaning.
inline bool EvaluateRangeBeam(const BeamFrame& frame, const double* point_in_world, double range_m,
                              const Eigen::Vector2d& beam, double inv_sigma_range,
                              double inv_sigma_bearing, double residuals[2], double* d_pose,
                              double* d_point) {
  const double dx = point_in_world[0] - frame.x, dy = point_in_world[1] - frame.y;
  const double squared_distance = dx * dx + dy * dy;
  if (!(squared_distance >= std::numeric_limits<double>::min())) return false;
  const double distance = std::sqrt(squared_distance);
  // Seen from the laser, and turned so that the beam is the first axis.
  const double x = frame.cos_yaw * dx + frame.sin_yaw * dy;
  const double y = frame.cos_yaw * dy - frame.sin_yaw * dx;
  const double off_beam_rad = AngleOf(beam.x() * x + beam.y() * y, beam.x() * y - beam.y() * x);
  residuals[0] = (distance - range_m) * inv_sigma_range;
  residuals[1] = off_beam_rad * inv_sigma_bearing;
  if (d_pose != nullptr || d_point != nullptr) {
    // Gradients of the two rows with respect to m; a move of the laser acts with opposite sign.
    const double radial = inv_sigma_range / distance;
    const double tangential = inv_sigma_bearing / squared_distance;
    const double range_x = radial * dx, range_y = radial * dy;
    const double bearing_x = -tangential * dy, bearing_y = tangential * dx;
    if (d_pose != nullptr) {
      d_pose[0] = -range_x;
      d_pose[1] = -range_y;
      d_pose[2] = range_x * frame.lever_y - range_y * frame.lever_x;
      d_pose[3] = -bearing_x;
      d_pose[4] = -bearing_y;
      d_pose[5] = bearing_x * frame.lever_y - bearing_y * frame.lever_x - inv_sigma_bearing;
    }
    if (d_point != nullptr) {
      d_point[0] = range_x;
      d_point[1] = range_y;
      d_point[2] = bearing_x;
      d_point[3] = bearing_y;
    }
  }
  return std::isfinite(residuals[0]) && std::isfinite(residuals[1]);
}

/// EvaluateRangeBeam for one return. Blocks: world_from_robot (3), point_in_world (2).
struct RangeBeamResidual {
  Pose2 robot_from_laser;
  double range_m = 0.0;
  double bearing_rad = 0.0;
  double inv_sigma_range = 1.0;    ///< [1/m]
  double inv_sigma_bearing = 1.0;  ///< [1/rad]

  bool Evaluate(const double* world_from_robot, const double* point_in_world, double* residuals,
                double* d_pose, double* d_point) const {
    return EvaluateRangeBeam(MakeBeamFrame(world_from_robot, robot_from_laser), point_in_world,
                             range_m, {std::cos(bearing_rad), std::sin(bearing_rad)},
                             inv_sigma_range, inv_sigma_bearing, residuals, d_pose, d_point);
  }
};

using RangeBeamFactor = AnalyticFactor<RangeBeamResidual, 2, 3, 2>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_RANGE_BEAM_FACTOR_H_
