#include "plumbline/apps/saved_maps/cartographer_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "plumbline/core/angle.h"
#include "plumbline/test/apps/saved_maps/pbstream_testing.h"

namespace plumbline {
namespace {

const Eigen::Quaterniond kTilt(Eigen::AngleAxisd(0.1, Eigen::Vector3d(0.6, 0.8, 0.0)));

TEST(CartographerPoseTest, ItsYawIsTheHeadingOfTheXAxis) {
  CartographerPose pose;
  ASSERT_TRUE(ReadCartographerPose(PbRigid3({1.0, -2.0, 0.5}, Turn(2.5)), &pose));
  EXPECT_EQ(pose.translation, Eigen::Vector3d(1.0, -2.0, 0.5));
  EXPECT_EQ(pose.InPlane().x, 1.0);
  EXPECT_EQ(pose.InPlane().y, -2.0);
  EXPECT_NEAR(pose.InPlane().yaw, 2.5, 1e-15);
  // A turn about the vertical adds to it, whatever the tilt.
  const double tilted = YawOf(kTilt);
  EXPECT_NEAR(NormalizeAngle(YawOf(Turn(3.0) * kTilt) - tilted - 3.0), 0.0, 1e-15);
}

TEST(CartographerPoseTest, MovingKeepsHeightAndTilt) {
  CartographerPose pose;
  ASSERT_TRUE(ReadCartographerPose(PbRigid3({1.0, 2.0, 0.75}, Turn(0.3) * kTilt), &pose));
  const CartographerPose moved = pose.MovedTo({-4.0, 5.0, -3.0});
  EXPECT_EQ(moved.translation, Eigen::Vector3d(-4.0, 5.0, 0.75));
  EXPECT_NEAR(moved.InPlane().yaw, -3.0, 1e-15);
  EXPECT_NEAR((moved.rotation * Eigen::Vector3d::UnitX()).z(),
              (kTilt * Eigen::Vector3d::UnitX()).z(), 1e-15);
  EXPECT_NEAR((moved.rotation * Eigen::Vector3d::UnitY()).z(),
              (kTilt * Eigen::Vector3d::UnitY()).z(), 1e-15);
}

TEST(CartographerPoseTest, WhatIsWrittenIsRead) {
  CartographerPose pose, again;
  ASSERT_TRUE(ReadCartographerPose(PbRigid3({1.0 / 3.0, 2.0, 0.0}, Turn(0.3) * kTilt), &pose));
  ASSERT_TRUE(ReadCartographerPose(CartographerPoseMessage(pose), &again));
  EXPECT_EQ(again.translation, pose.translation);
  EXPECT_EQ(again.rotation.coeffs(), pose.rotation.coeffs());
}

TEST(CartographerPoseTest, PosesThatAreNoneAreRefused) {
  CartographerPose pose;
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  EXPECT_TRUE(ReadCartographerPose(PbRigid3(origin, Turn(1.0)), &pose));
  for (const std::string& message :
       {std::string(), PbBytes(1, PbDouble(1, 2.0)),
        PbRigid3(origin, Eigen::Quaterniond(1.1, 0.0, 0.0, 0.0)),
        PbRigid3(origin, Eigen::Quaterniond(0.5, 0.5, 0.0, 0.0)),
        PbRigid3(origin, Eigen::Quaterniond(nan, 0.0, 0.0, 1.0)),
        PbRigid3({nan, 0.0, 0.0}, Turn(0.0)), PbRigid3({0.0, 1e8, 0.0}, Turn(0.0)),
        PbRigid3({0.0, 0.0, infinity}, Turn(0.0)),
        PbBytes(1, PbTag(1, 1) + "short") + PbBytes(2, PbQuaternion(Turn(0.0))),
        PbRigid3(origin, Turn(1.0)) + "\x7f"}) {
    EXPECT_FALSE(ReadCartographerPose(message, &pose));
  }
  Eigen::Quaterniond rotation;
  EXPECT_FALSE(ReadQuaternion("", &rotation));
  EXPECT_FALSE(ReadQuaternion(PbInt(4, 1), &rotation));
}

}  // namespace
}  // namespace plumbline
