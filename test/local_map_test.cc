#include "plumbline/solvers/seeding/local_map.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

const Eigen::Vector2d kUp(0.0, 1.0);
const Eigen::Vector2d kRight(1.0, 0.0);

TEST(LocalMap, AveragesPointsOfOneCellAndDirection) {
  LocalMap map(0.1);
  const SurfacePoints first{{{1.02, 2.02}, kUp}}, second{{{0.04, 0.06}, kUp}};
  // The second scan is seen from (1, 2): its point falls into the same cell, at (1.04, 2.06).
  map.Rebuild({&first, &second}, {Pose2(), Pose2(1.0, 2.0, 0.0)});
  ASSERT_EQ(map.points().size(), 1u);
  EXPECT_NEAR(map.points()[0].position.x(), 1.03, 1e-12);
  EXPECT_NEAR(map.points()[0].position.y(), 2.04, 1e-12);
}

TEST(LocalMap, KeepsTheTwoFacesOfAWallApart) {
  LocalMap map(0.1);
  const SurfacePoints scan{{{1.02, 2.02}, kUp}, {{1.04, 2.04}, -kUp}};
  map.Rebuild({&scan}, {Pose2()});
  EXPECT_EQ(map.points().size(), 2u);
  const SurfacePoint* nearest = map.Nearest({{1.02, 2.02}, -kUp}, 0.5);
  ASSERT_NE(nearest, nullptr);
  EXPECT_NEAR(nearest->position.y(), 2.04, 1e-12);
}

TEST(LocalMap, TurnsPointsAndNormalsWithTheRobot) {
  LocalMap map(0.1);
  const SurfacePoints scan{{{1.0, 0.0}, kRight}};
  map.Rebuild({&scan}, {Pose2(0.0, 0.0, kPi / 2.0)});
  ASSERT_EQ(map.points().size(), 1u);
  EXPECT_NEAR((map.points()[0].position - kUp).norm(), 0.0, 1e-12);
  EXPECT_NEAR((map.points()[0].normal - kUp).norm(), 0.0, 1e-12);
}

TEST(LocalMap, FindsNothingBeyondTheRadiusOrInAnEmptyMap) {
  LocalMap map(0.1);
  EXPECT_EQ(map.Nearest({{0.0, 0.0}, kUp}, 1.0), nullptr);
  const SurfacePoints scan{{{0.0, 0.0}, kUp}, {{2.0, 0.0}, kUp}};
  map.Rebuild({&scan}, {Pose2()});
  EXPECT_EQ(map.Nearest({{1.0, 0.0}, kUp}, 0.9), nullptr);
  EXPECT_EQ(map.Nearest({{-50.0, 70.0}, kUp}, 0.9), nullptr);
  const SurfacePoint* nearest = map.Nearest({{1.2, 0.0}, kUp}, 0.9);
  ASSERT_NE(nearest, nullptr);
  EXPECT_EQ(nearest->position.x(), 2.0);
}

}  // namespace
}  // namespace plumbline
