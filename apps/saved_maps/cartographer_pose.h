#ifndef PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_POSE_H_
#define PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_POSE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <string_view>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// A pose in space as Cartographer has it, also where it maps the plane: a tracking frame is tilted
/// by what the IMU says.
struct CartographerPose {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond(0, 0, 0, 0);  ///< a unit quaternion

  /// The pose in the plane. Its yaw is the heading of the frame's x axis.
  Pose2 InPlane() const;
  /// The same pose, moved in the plane and turned about the vertical to get there: height and tilt
  /// stay.
  CartographerPose MovedTo(const Pose2& in_plane) const;
};

/// Heading of the x axis [rad] after a rotation.
double YawOf(const Eigen::Quaterniond& rotation);

/// Reads a message Quaterniond or Rigid3d. False if it is damaged, if the quaternion's norm is not
/// 1, or if the pose is beyond input_limits.h.
bool ReadQuaternion(std::string_view message, Eigen::Quaterniond* rotation);
bool ReadCartographerPose(std::string_view message, CartographerPose* pose);

/// The message Rigid3d.
std::string CartographerPoseMessage(const CartographerPose& pose);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_POSE_H_
