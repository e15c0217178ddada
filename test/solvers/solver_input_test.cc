#include "plumbline/solvers/solver_input.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "plumbline/core/fixed_poses.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

const Pose2 kElsewhere(4.0, -7.0, 5.0);

Eigen::Vector2d PointInRobot(const NoisyRoom& room, const MapState& state, std::size_t r) {
  const int pose = room.graph.scan(room.graph.ScanOfReturn(r)).pose;
  return state.WorldFromRobot(pose).Inverse() * MapPoint(state, r);
}

// Off the optimum, with points that are not where the beams end.
NoisyRoom DisturbedRoom() {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.02, room.graph, &room.state);
  DisturbPoints(0.01, &room.state);
  return room;
}

void ExpectPointsKeptTheirPlaceInTheRobot(const NoisyRoom& room, const MapState& before) {
  for (std::size_t r = 0; r < room.graph.num_returns(); ++r) {
    ASSERT_LT((PointInRobot(room, room.state, r) - PointInRobot(room, before, r)).norm(), 1e-12);
  }
}

TEST(PutAtFixedPosesTest, NothingChangesWhereAllAreInPlace) {
  NoisyRoom room = DisturbedRoom();  // the first pose is where it was
  for (const int num_named : {0, 2}) {
    if (num_named > 0) {
      for (const int pose : {9, 4}) {
        room.graph.FixPose(pose, room.state.WorldFromRobot(pose));
      }
    }
    const MapState before = room.state;
    EXPECT_TRUE(IsAtFixedPoses(room.graph, room.state));
    PutAtFixedPoses(room.graph, &room.state);
    EXPECT_EQ(room.state, before);
  }
}

TEST(PutAtFixedPosesTest, AGraphWithoutPosesHasNone) {
  MapState state;
  EXPECT_TRUE(IsAtFixedPoses(SlamGraph(), state));
  PutAtFixedPoses(SlamGraph(), &state);
  EXPECT_EQ(state, MapState());
}

TEST(PutAtFixedPosesTest, TheWholeMapGoesAlongWithTheFixedPose) {
  NoisyRoom room = DisturbedRoom();
  room.graph.FixPose(5, kElsewhere);
  const MapState before = room.state;
  EXPECT_FALSE(IsAtFixedPoses(room.graph, room.state));
  PutAtFixedPoses(room.graph, &room.state);
  EXPECT_TRUE(IsAtFixedPoses(room.graph, room.state));
  EXPECT_EQ(ToBlock(room.state.WorldFromRobot(5)), ToBlock(kElsewhere));
  for (int pose = 0; pose < room.graph.num_poses(); ++pose) {
    const Pose2 was = Between(before.WorldFromRobot(5), before.WorldFromRobot(pose));
    const Pose2 is = Between(kElsewhere, room.state.WorldFromRobot(pose));
    EXPECT_NEAR(is.x, was.x, 1e-12) << pose;
    EXPECT_NEAR(is.y, was.y, 1e-12) << pose;
    EXPECT_NEAR(is.yaw, was.yaw, 1e-12) << pose;
  }
  ExpectPointsKeptTheirPlaceInTheRobot(room, before);
}

// By the first that FixPose named, whatever its id.
TEST(PutAtFixedPosesTest, OtherFixedPosesAreMovedByThemselvesWithTheirPoints) {
  NoisyRoom room = DisturbedRoom();
  room.graph.FixPose(8, room.state.WorldFromRobot(8));
  room.graph.FixPose(2, kElsewhere);
  const MapState before = room.state;
  EXPECT_FALSE(IsAtFixedPoses(room.graph, room.state));
  PutAtFixedPoses(room.graph, &room.state);
  EXPECT_TRUE(IsAtFixedPoses(room.graph, room.state));
  for (int pose = 0; pose < room.graph.num_poses(); ++pose) {
    const Pose2 expected = pose == 2 ? kElsewhere : before.WorldFromRobot(pose);
    EXPECT_EQ(ToBlock(room.state.WorldFromRobot(pose)), ToBlock(expected)) << pose;
  }
  for (std::size_t r = 0; r < room.graph.num_returns(); ++r) {
    const bool is_moved = room.graph.scan(room.graph.ScanOfReturn(r)).pose == 2;
    ASSERT_EQ(MapPoint(room.state, r) == MapPoint(before, r), !is_moved) << r;
  }
  ExpectPointsKeptTheirPlaceInTheRobot(room, before);
}

TEST(PutAtFixedPosesTest, ATurnIsNotTheSameHeading) {
  NoisyRoom room = MakeNoisyRoom();
  Pose2 turned = room.state.WorldFromRobot(0);
  turned.yaw += 2.0 * kPi;
  room.graph.FixPose(0, turned);
  EXPECT_FALSE(IsAtFixedPoses(room.graph, room.state));
  PutAtFixedPoses(room.graph, &room.state);
  EXPECT_EQ(room.state.WorldFromRobot(0).yaw, turned.yaw);
  EXPECT_TRUE(IsAtFixedPoses(room.graph, room.state));
}

}  // namespace
}  // namespace plumbline
