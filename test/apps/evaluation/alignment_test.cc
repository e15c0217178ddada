#include "plumbline/apps/evaluation/alignment.h"

#include <gtest/gtest.h>

#include <vector>

namespace plumbline {
namespace {

TEST(AlignmentTest, RecoversTheMotionBetweenTwoWorldFrames) {
  const Pose2 truth_from_world(3.0, -200.0, -2.9);
  std::vector<Pose2> estimate, truth;
  for (int i = 0; i < 20; ++i) {
    estimate.emplace_back(0.1 * i * i, 2.0 - i, 0.3 * i);
    truth.push_back(truth_from_world * estimate.back());
  }
  const Pose2 aligned = AlignTrajectories(estimate, truth);
  EXPECT_NEAR(aligned.x, 3.0, 1e-10);
  EXPECT_NEAR(aligned.y, -200.0, 1e-10);
  EXPECT_NEAR(aligned.yaw, -2.9, 1e-12);
}

TEST(AlignmentTest, PositionsCountAndHeadingsDoNot) {
  // Two points 2 m apart against two 4 m apart: 1 m is left at each, whatever the robot looked at.
  const Pose2 aligned =
      AlignTrajectories({{0.0, 0.0, 0.3}, {2.0, 0.0, -1.0}}, {{5.0, 1.0, 2.0}, {5.0, 5.0, 0.0}});
  const Eigen::Vector2d first = aligned * Eigen::Vector2d(0.0, 0.0);
  const Eigen::Vector2d second = aligned * Eigen::Vector2d(2.0, 0.0);
  EXPECT_NEAR((first - Eigen::Vector2d(5.0, 2.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((second - Eigen::Vector2d(5.0, 4.0)).norm(), 0.0, 1e-12);
}

TEST(AlignmentTest, ARobotThatNeverMovesGivesItsFirstHeading) {
  const Pose2 aligned =
      AlignTrajectories({{1.0, 0.0, 0.5}, {1.0, 0.0, 0.6}}, {{4.0, 7.0, 0.9}, {4.0, 7.0, 0.1}});
  EXPECT_NEAR(aligned.yaw, 0.4, 1e-12);
  EXPECT_NEAR((aligned * Eigen::Vector2d(1.0, 0.0) - Eigen::Vector2d(4.0, 7.0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace plumbline
