#include "plumbline/apps/saved_maps/cartographer_pose.h"

#include <cmath>

#include "plumbline/apps/saved_maps/proto_reader.h"
#include "plumbline/apps/saved_maps/proto_writer.h"
#include "plumbline/core/input_limits.h"

namespace plumbline {

double YawOf(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d x_axis = rotation * Eigen::Vector3d::UnitX();
  return std::atan2(x_axis.y(), x_axis.x());
}

Pose2 CartographerPose::InPlane() const {
  return {translation.x(), translation.y(), YawOf(rotation)};
}

CartographerPose CartographerPose::MovedTo(const Pose2& in_plane) const {
  const Eigen::AngleAxisd turn(in_plane.yaw - YawOf(rotation), Eigen::Vector3d::UnitZ());
  CartographerPose moved;
  moved.translation = {in_plane.x, in_plane.y, translation.z()};
  moved.rotation = turn * rotation;
  return moved;
}

bool ReadQuaternion(std::string_view message, Eigen::Quaterniond* rotation) {
  constexpr double kTolerance = 0.01;
  *rotation = Eigen::Quaterniond(0, 0, 0, 0);
  ProtoReader fields(message);
  while (fields.Next()) {
    // x, y, z, w, as Eigen stores them.
    if (fields.number() <= 4) rotation->coeffs()[fields.number() - 1] = fields.Double();
  }
  return fields.ok() && std::abs(rotation->norm() - 1.0) <= kTolerance;
}

bool ReadCartographerPose(std::string_view message, CartographerPose* pose) {
  *pose = CartographerPose();
  ProtoReader fields(message);
  while (fields.Next()) {
    if (fields.number() == 1) {
      ProtoReader translation(fields.Bytes());
      while (translation.Next()) {
        if (translation.number() > 3) continue;
        pose->translation[static_cast<int>(translation.number()) - 1] = translation.Double();
      }
      if (!translation.ok()) return false;
    } else if (fields.number() == 2 && !ReadQuaternion(fields.Bytes(), &pose->rotation)) {
      return false;
    }
  }
  // Without a rotation, the norm is zero.
  return fields.ok() && pose->rotation.norm() > 0.0 && IsWithinLimits(pose->InPlane()) &&
         std::isfinite(pose->translation.z());
}

std::string CartographerPoseMessage(const CartographerPose& pose) {
  ProtoWriter translation, rotation, message;
  for (int i = 0; i < 3; ++i) translation.Double(i + 1, pose.translation[i]);
  for (int i = 0; i < 4; ++i) rotation.Double(i + 1, pose.rotation.coeffs()[i]);
  message.Bytes(1, translation.bytes());
  message.Bytes(2, rotation.bytes());
  return message.bytes();
}

}  // namespace plumbline
