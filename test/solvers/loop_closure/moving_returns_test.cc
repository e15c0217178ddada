#include "plumbline/solvers/loop_closure/moving_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

constexpr int kNumScans = 15;

/// A drive along a room of 20 m x 8 m, a scan every half metre. In each scan a person stands where
/// `person` says; others follow a metre and a half ahead of each other.
SlamGraph Drive(const std::vector<std::optional<Eigen::Vector2d>>& person, int num_people = 1) {
  SlamGraph graph;
  for (int i = 0; i < kNumScans; ++i) {
    SyntheticScene scene;
    scene.faces = Rectangle({-10.0, -4.0}, {10.0, 4.0});
    for (int k = 0; person[i] && k < num_people; ++k) {
      scene.discs.push_back(
          {*person[i] + Eigen::Vector2d(1.5 * k - (k > 1 ? 5.0 : 0.0), 0.0), 0.25});
    }
    scene.laser = PanoramicLaser(360);
    scene.poses = {Pose2(-3.5 + 0.5 * i, 0.0, 0.0)};
    const SlamGraph one = MakeGraph(scene);
    if (i == 0) {
      graph.AddLaser(scene.laser);
    }
    const int pose = graph.AddPose(scene.poses[0], i);
    graph.AddScan(pose, 0, one.RangesOfScan(0, scene.laser.max_range_m));
  }
  return graph;
}

std::vector<std::optional<Eigen::Vector2d>> Nobody() {
  return std::vector<std::optional<Eigen::Vector2d>>(kNumScans);
}

/// Walks across the robot's path, half a metre from scan to scan.
std::vector<std::optional<Eigen::Vector2d>> Walker() {
  std::vector<std::optional<Eigen::Vector2d>> person;
  for (int i = 0; i < kNumScans; ++i) person.push_back(Eigen::Vector2d(2.0, 3.5 - 0.5 * i));
  return person;
}

std::vector<int> AllScans() {
  std::vector<int> scans;
  for (int i = 0; i < kNumScans; ++i) scans.push_back(i);
  return scans;
}

std::vector<Pose2> PosesOfDrive(const SlamGraph& graph) { return PosesOf(graph.initial_poses()); }

std::vector<std::vector<int>> FindMoving(const SlamGraph& graph, const std::vector<Pose2>& poses) {
  const ScanSurfaces surfaces(graph, std::vector<PackedSurface>(kNumScans));
  ThreadPool pool(2);
  return FindMovingReturns(surfaces, AllScans(), AllScans(), poses, &pool);
}

TEST(MovingReturnsTest, APersonWhoWalksIsFound) {
  const auto person = Walker();
  const SlamGraph graph = Drive(person);
  const std::vector<Pose2> poses = PosesOfDrive(graph);
  const std::vector<std::vector<int>> moving = FindMoving(graph, poses);
  for (int i = 0; i < kNumScans; ++i) {
    // In the middle of the room, from 1 to 5 m away: some 6 to 30 beams of a degree.
    EXPECT_GE(moving[i].size(), i >= 3 && i <= 8 ? 4u : 0u) << i;
    const FreeSpaceScan scan(graph, i);
    for (const int place : moving[i]) {
      EXPECT_NEAR((poses[i] * scan.returns()[place] - *person[i]).norm(), 0.25, 0.01) << i;
    }
  }
}

TEST(MovingReturnsTest, APersonWhoStandsIsNot) {
  auto person = Nobody();
  for (auto& place : person) place = Eigen::Vector2d(2.0, 1.5);
  const SlamGraph graph = Drive(person);
  for (const auto& moving : FindMoving(graph, PosesOfDrive(graph))) EXPECT_TRUE(moving.empty());
}

TEST(MovingReturnsTest, WhatTellsOfAJumpIsNotMarked) {
  const SlamGraph graph = Drive(Nobody());
  std::vector<Pose2> poses = PosesOfDrive(graph);
  for (int i = kNumScans / 2; i < kNumScans; ++i) poses[i].y += 1.0;
  // Scans of one side do look through what those of the other see.
  const FreeSpaceConflict across = CompareBothWays(FreeSpaceScan(graph, 6), FreeSpaceScan(graph, 7),
                                                   Between(poses[6], poses[7]));
  ASSERT_GT(across.num_conflicting, 50);
  for (const auto& moving : FindMoving(graph, poses)) EXPECT_LE(moving.size(), 2u);  // in corners
}

TEST(MovingReturnsTest, AScanOutOfPlaceKeepsItsReturns) {
  const SlamGraph graph = Drive(Nobody());
  std::vector<Pose2> poses = PosesOfDrive(graph);
  poses[7].yaw += 0.5 * kPi;
  EXPECT_TRUE(FindMoving(graph, poses)[7].empty());
}

std::vector<std::size_t> FindMovingOfDrive(const SlamGraph& graph,
                                           const std::vector<Pose2>& poses) {
  ThreadPool pool(2);
  const MeasuredSurface surface = MeasureSurface(graph, ReturnNormalOptions(), &pool);
  return FindMovingReturnsOfDrive(ScanSurfaces(graph, surface), poses, &pool);
}

// Four who walk across, one behind the other.
SlamGraph DriveAmongPeople() { return Drive(Walker(), 4); }

TEST(MovingReturnsTest, PeopleOfAWholeDriveAreFoundAndNothingElse) {
  const SlamGraph graph = DriveAmongPeople();
  const std::vector<Pose2> poses = PosesOfDrive(graph);
  const std::vector<std::size_t> moving = FindMovingOfDrive(graph, poses);
  EXPECT_GT(moving.size(), graph.num_returns() / 40);
  EXPECT_TRUE(std::is_sorted(moving.begin(), moving.end()));
  for (const std::size_t r : moving) {
    const Eigen::Vector2d end =
        poses[graph.scan(graph.ScanOfReturn(r)).pose] * graph.PointInRobot(r);
    EXPECT_LT(std::abs(end.x()), 9.9) << r;
    EXPECT_LT(std::abs(end.y()), 3.9) << r;
  }
}

TEST(MovingReturnsTest, OfADriveWithFewItFindsNone) {
  const SlamGraph alone = Drive(Nobody());
  EXPECT_TRUE(FindMovingOfDrive(alone, PosesOfDrive(alone)).empty());
}

TEST(MovingReturnsTest, WallsThatTellOfAJumpAreNotLeftOutOfADrive) {
  const SlamGraph graph = DriveAmongPeople();
  const std::vector<Pose2> sound = PosesOfDrive(graph);
  std::vector<Pose2> torn = sound;
  for (int i = kNumScans / 2; i < kNumScans; ++i) torn[i].y += 1.0;
  std::size_t num_on_walls = 0;
  for (const std::size_t r : FindMovingOfDrive(graph, torn)) {
    const Eigen::Vector2d end =
        sound[graph.scan(graph.ScanOfReturn(r)).pose] * graph.PointInRobot(r);
    if (std::abs(end.y()) > 3.9) ++num_on_walls;
  }
  // Between two people a piece of a wall is no larger than they are.
  EXPECT_LT(num_on_walls, graph.num_returns() / 300);
}

TEST(MovingReturnsTest, ARoomThatIsOutOfPlaceForAWhileDoesNotMove) {
  const SlamGraph graph = Drive(Nobody());
  std::vector<Pose2> poses = PosesOfDrive(graph);
  for (int i = 6; i < 9; ++i) poses[i].y += 1.0;
  EXPECT_TRUE(FindMovingOfDrive(graph, poses).empty());
}

TEST(MovingReturnsTest, ProcessesThatShareADriveFindTheSame) {
  const SlamGraph graph = DriveAmongPeople();
  const std::vector<Pose2> poses = PosesOfDrive(graph);
  const std::vector<std::size_t> expected = FindMovingOfDrive(graph, poses);
  ASSERT_FALSE(expected.empty());
  RunOnParts(graph, 3, [&](const SlamGraph& part) {
    EXPECT_EQ(FindMovingOfDrive(part, poses), expected);
    const SlamGraph marked = part.Corrected({{}, {}, {}, {}, expected});
    for (std::size_t r = 0; r < marked.num_returns(); ++r) {
      EXPECT_EQ(marked.Moves(r),
                std::binary_search(expected.begin(), expected.end(), marked.ReturnIdAmongAll(r)));
    }
  });
}

TEST(MovingReturnsTest, ProcessesThatShareAGraphMarkTheSame) {
  const SlamGraph graph = Drive(Walker());
  const std::vector<Pose2> poses = PosesOfDrive(graph);
  const std::vector<std::vector<int>> expected = FindMoving(graph, poses);
  RunOnParts(graph, 3, [&](const SlamGraph& part) {
    ASSERT_LT(part.num_scans(), graph.num_scans());
    EXPECT_EQ(FindMoving(part, poses), expected);
  });
}

}  // namespace
}  // namespace plumbline
