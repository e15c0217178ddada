#include "plumbline/factors/motion_factor.h"

#include <cmath>
#include <limits>

#include "plumbline/core/angle.h"
#include "plumbline/factors/sqrt_information.h"

namespace plumbline {
namespace {

// Below this length the direction of a step is mostly the odometry's resolution [m].
constexpr double kDirectionFadeLength = 0.02;

// A step as the drive that produced it [rad, m, rad].
struct Drive {
  double rotation_1 = 0.0;
  double translation = 0.0;
  double rotation_2 = 0.0;
};

Drive DriveOf(const Pose2& step) {
  const double sign = std::copysign(1.0, step.x);
  const double squared_length = step.x * step.x + step.y * step.y;
  const double direction_weight =
      squared_length / (squared_length + kDirectionFadeLength * kDirectionFadeLength);
  Drive drive;
  drive.rotation_1 = direction_weight * std::atan2(sign * step.y, std::abs(step.x));
  drive.translation = sign * std::sqrt(squared_length);
  drive.rotation_2 = NormalizeAngle(step.yaw - drive.rotation_1);
  return drive;
}

// Standard deviations of (rotation_1, translation, rotation_2) [rad, m, rad].
Eigen::Vector3d DriveSigmas(const Drive& drive, const MotionOptions& options) {
  const double rotation_1 = std::abs(drive.rotation_1);
  const double translation = std::abs(drive.translation);
  const double rotation_2 = std::abs(drive.rotation_2);
  return {options.rotation_per_rotation * rotation_1 +
              options.rotation_per_translation_rad_m * translation,
          options.translation_per_translation * translation +
              options.translation_per_rotation_m_rad * (rotation_1 + rotation_2),
          options.rotation_per_rotation * rotation_2 +
              options.rotation_per_translation_rad_m * translation};
}

}  // namespace

Eigen::Matrix3d MotionCovariance(const Pose2& from_from_to, const MotionOptions& options) {
  const Drive drive = DriveOf(from_from_to);
  // d(dx, dy, dyaw) / d(rotation_1, translation, rotation_2).
  Eigen::Matrix3d jacobian;
  jacobian << -from_from_to.y, std::cos(drive.rotation_1), 0.0,  //
      from_from_to.x, std::sin(drive.rotation_1), 0.0,           //
      1.0, 0.0, 1.0;
  const Eigen::Matrix3d noise = jacobian * DriveSigmas(drive, options).asDiagonal();
  const Eigen::Vector3d floors(options.translation_floor_m, options.translation_floor_m,
                               options.rotation_floor_rad);
  Eigen::Matrix3d covariance = noise * noise.transpose();
  covariance.diagonal() += floors.cwiseAbs2();
  return covariance;
}

MotionResidual MakeMotionResidual(const Pose2& from_from_to, const MotionOptions& options) {
  MotionResidual residual;
  residual.a_from_b = from_from_to;
  if (!SqrtInformation(MotionCovariance(from_from_to, options), &residual.sqrt_information)) {
    residual.sqrt_information.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return residual;
}

}  // namespace plumbline
