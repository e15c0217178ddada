#include "plumbline/core/map_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

MapState TwoPosesAndAPoint() { return {{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {7.0, 8.0}}; }

TEST(MapStateTest, APoseIsThreeNumbers) {
  const MapState state = TwoPosesAndAPoint();
  EXPECT_EQ(MapState().num_poses(), 0);
  EXPECT_EQ(state.num_poses(), 2);
  EXPECT_EQ(state.WorldFromRobot(1).x, 4.0);
  EXPECT_EQ(state.WorldFromRobot(1).y, 5.0);
  EXPECT_EQ(state.WorldFromRobot(1).yaw, 6.0);
}

TEST(MapStateTest, SettingAPoseMovesItAlone) {
  MapState state = TwoPosesAndAPoint();
  state.SetPose(0, Pose2(-1.0, -2.0, 10.0));  // a yaw is not wrapped
  EXPECT_THAT(state.poses, ElementsAre(-1.0, -2.0, 10.0, 4.0, 5.0, 6.0));
  EXPECT_THAT(state.points, ElementsAre(7.0, 8.0));
}

TEST(MapStateTest, EqualStatesHaveTheSameNumbers) {
  const MapState state = TwoPosesAndAPoint();
  MapState other = state;
  EXPECT_TRUE(state == other);
  EXPECT_FALSE(state != other);
  other.SetPose(1, Pose2(4.0, 5.0, std::nextafter(6.0, 7.0)));
  EXPECT_TRUE(state != other);
  other = state;
  other.points[1] = 9.0;
  EXPECT_TRUE(state != other);
  other = state;
  other.points.clear();
  EXPECT_TRUE(state != other);
}

TEST(MapStateTest, PosesAndTheirArraysAreInversesOfEachOther) {
  const std::vector<double> array = TwoPosesAndAPoint().poses;
  const std::vector<Pose2> poses = PosesOf(array);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].yaw, 3.0);
  EXPECT_EQ(poses[1].x, 4.0);
  EXPECT_EQ(PoseArray(poses), array);
  EXPECT_THAT(PosesOf({}), IsEmpty());
  EXPECT_THAT(PoseArray({}), IsEmpty());
}

}  // namespace
}  // namespace plumbline
