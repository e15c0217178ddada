#include "plumbline/core/pose2.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace plumbline {
namespace {

// Half turns on both sides of the cut, whole turns, tiny and huge motions.
std::vector<Pose2> NastyPoses() {
  std::vector<Pose2> poses;
  for (const double yaw : {0.0, 1e-12, 0.5 * kPi, kPi, -kPi, std::nextafter(kPi, 0.0), 2.0 * kPi,
                           -3.0 * kPi, 1.2, 25.0}) {
    poses.emplace_back(0.0, 0.0, yaw);
    poses.emplace_back(-3.5, 1e-9, yaw);
    poses.emplace_back(400.0, -250.0, yaw);
  }
  return poses;
}

void ExpectSameMotion(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x, b.x, 1e-11);
  EXPECT_NEAR(a.y, b.y, 1e-11);
  EXPECT_NEAR(NormalizeAngle(a.yaw - b.yaw), 0.0, 1e-13);
}

TEST(Pose2, ComposesAndMapsAsWorkedByHand) {
  const Pose2 world_from_robot(1.0, 2.0, 0.5 * kPi);
  ExpectSameMotion(world_from_robot * Pose2(3.0, 4.0, 0.25), Pose2(-3.0, 5.0, 0.5 * kPi + 0.25));
  EXPECT_TRUE((world_from_robot * Eigen::Vector2d(3.0, 4.0)).isApprox(Eigen::Vector2d(-3.0, 5.0)));
  ExpectSameMotion(world_from_robot.Inverse(), Pose2(-2.0, 1.0, -0.5 * kPi));
  EXPECT_EQ(world_from_robot.translation(), Eigen::Vector2d(1.0, 2.0));
}

TEST(Pose2, IsAGroupThatActsOnPoints) {
  const std::vector<Pose2> poses = NastyPoses();
  const Pose2 identity;
  const Eigen::Vector2d point(0.7, -12.0);
  for (const Pose2& a : poses) {
    ExpectSameMotion(a * identity, a);
    ExpectSameMotion(identity * a, a);
    ExpectSameMotion(a * a.Inverse(), identity);
    ExpectSameMotion(a.Inverse() * a, identity);
    for (const Pose2& b : poses) {
      EXPECT_LT((a * (b * point) - (a * b) * point).norm(), 1e-11);
      ExpectSameMotion((a * b).Inverse(), b.Inverse() * a.Inverse());
      for (const Pose2& c : poses) ExpectSameMotion((a * b) * c, a * (b * c));
    }
  }
}

TEST(Pose2, BetweenIsTheRelativePoseWithWrappedYaw) {
  for (const Pose2& a : NastyPoses()) {
    for (const Pose2& b : NastyPoses()) {
      const Pose2 a_from_b = Between(a, b);
      ExpectSameMotion(a_from_b, a.Inverse() * b);
      ExpectSameMotion(a * a_from_b, b);
      EXPECT_GE(a_from_b.yaw, -kPi);
      EXPECT_LT(a_from_b.yaw, kPi);
    }
  }
}

TEST(Pose2, YawAddsUpUnwrapped) {
  EXPECT_DOUBLE_EQ((Pose2(0, 0, 3.0) * Pose2(0, 0, 3.0)).yaw, 6.0);
}

TEST(Pose2, JetsCarryTheDerivatives) {
  using Jet = ceres::Jet<double, 3>;
  const SE2<Jet> a(Jet(1.0, 0), Jet(2.0, 1), Jet(0.8, 2));
  const SE2<Jet> b(Jet(3.0), Jet(-4.0), Jet(0.1));
  const double c = std::cos(0.8), s = std::sin(0.8);

  const SE2<Jet> product = a * b;
  EXPECT_TRUE(product.x.v.isApprox(Eigen::Vector3d(1.0, 0.0, -s * 3.0 + c * 4.0)));
  EXPECT_TRUE(product.y.v.isApprox(Eigen::Vector3d(0.0, 1.0, c * 3.0 + s * 4.0)));
  EXPECT_TRUE(product.yaw.v.isApprox(Eigen::Vector3d(0.0, 0.0, 1.0)));

  const SE2<Jet> between = Between(a, b);  // Inverse of a, then b.
  EXPECT_TRUE(between.x.v.isApprox(Eigen::Vector3d(-c, -s, -s * 2.0 + c * -6.0)));
  EXPECT_TRUE(between.y.v.isApprox(Eigen::Vector3d(s, -c, -c * 2.0 - s * -6.0)));
  EXPECT_TRUE(between.yaw.v.isApprox(Eigen::Vector3d(0.0, 0.0, -1.0)));
}

TEST(Pose2, ReadsAParameterBlock) {
  const double block[3] = {1.0, 2.0, 3.0};
  const Pose2 pose(block);
  EXPECT_EQ(pose.x, 1.0);
  EXPECT_EQ(pose.y, 2.0);
  EXPECT_EQ(pose.yaw, 3.0);
}

TEST(Pose2, FiniteMeansEveryCoordinate) {
  EXPECT_TRUE(IsFinite(Pose2(1.0, 2.0, 3.0)));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(IsFinite(Pose2(bad, 0.0, 0.0)));
    EXPECT_FALSE(IsFinite(Pose2(0.0, bad, 0.0)));
    EXPECT_FALSE(IsFinite(Pose2(0.0, 0.0, bad)));
  }
}

}  // namespace
}  // namespace plumbline
