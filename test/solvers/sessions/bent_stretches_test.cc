#include "plumbline/solvers/sessions/bent_stretches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

// A pose every 0.2 m along a curve.
std::vector<Pose2> Drive(int num_poses) {
  std::vector<Pose2> poses = {Pose2(3.0, -2.0, 0.4)};
  while (static_cast<int>(poses.size()) < num_poses) {
    poses.push_back(poses.back() * Pose2(0.2, 0.0, 0.02));
  }
  return poses;
}

TEST(BentStretchesTest, AMapThatIsMovedAsAWholeIsNotBent) {
  const std::vector<Pose2> own = Drive(100);
  std::vector<Pose2> moved;
  for (const Pose2& pose : own) moved.push_back(Pose2(20.0, 5.0, 2.0) * pose);
  EXPECT_THAT(FindBentStretches(own, moved, 0), IsEmpty());
  EXPECT_THAT(FindBentStretches({}, {}, 0), IsEmpty());
  EXPECT_THAT(FindBentStretches({own[0]}, {moved[0]}, 0), IsEmpty());
}

TEST(BentStretchesTest, DriftThatIsSharedOutIsNoBend) {
  const std::vector<Pose2> own = Drive(100);
  std::vector<Pose2> in_map = own;
  for (std::size_t i = 0; i < own.size(); ++i) in_map[i].x += 0.02 * static_cast<double>(i);
  EXPECT_THAT(FindBentStretches(own, in_map, 0), IsEmpty());
}

TEST(BentStretchesTest, FindsWhereAPartIsPushedAside) {
  const std::vector<Pose2> own = Drive(100);
  std::vector<Pose2> in_map = own;
  for (std::size_t i = 40; i < 70; ++i) in_map[i].y += 0.35;
  const std::vector<BentStretch> bent = FindBentStretches(own, in_map, 1000);
  ASSERT_THAT(bent, SizeIs(2));  // into it, and out of it
  EXPECT_LT(bent[0].first_pose, 1040);
  EXPECT_GE(bent[0].last_pose, 1040);
  EXPECT_NEAR(bent[0].bend_m, 0.35, 0.01);
  EXPECT_LT(bent[1].first_pose, 1070);
  EXPECT_GE(bent[1].last_pose, 1070);
}

TEST(BentStretchesTest, LessThanAFifthOfTheStretchIsNoBend) {
  const std::vector<Pose2> own = Drive(100);
  std::vector<Pose2> in_map = own;
  for (std::size_t i = 40; i < 70; ++i) in_map[i].y += 0.19;
  EXPECT_THAT(FindBentStretches(own, in_map, 0), IsEmpty());
}

}  // namespace
}  // namespace plumbline
