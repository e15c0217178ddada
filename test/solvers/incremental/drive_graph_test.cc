#include "plumbline/solvers/incremental/drive_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr int kNumPoses = 41;

// A straight drive along x with 0.25 m between poses; nothing was scanned.
SlamGraph StraightDrive() {
  SlamGraph graph;
  for (int i = 0; i < kNumPoses; ++i) {
    graph.AddPose({0.25 * i, 0.0, 0.0}, i);
    if (i > 0) graph.AddOdometry({i - 1, i, {0.25, 0.0, 0.0}});
  }
  return graph;
}

DriveGraph Measured(const SlamGraph& graph) {
  DriveGraph drive{MotionOptions()};
  drive.Extend(graph, MeasuredSurface());
  drive.Measure(graph.num_poses(), graph.initial_poses());
  return drive;
}

RelativePoseConstraint Closure(int from, int to, const Pose2& from_from_to) {
  return {from, to, from_from_to, Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal()};
}

TEST(DriveGraphTest, AClosureIsSpreadOverAllSteps) {
  const SlamGraph graph = StraightDrive();
  DriveGraph drive = Measured(graph);
  std::vector<double> poses = graph.initial_poses();
  drive.Close({}, {Closure(0, kNumPoses - 1, {10.0, 0.8, 0.0})}, graph.fixed_poses(), &poses);
  EXPECT_NEAR(poses[3 * (kNumPoses - 1) + 1], 0.8, 0.05);
  double largest_turn_rad = 0.0;
  for (int i = 1; i < kNumPoses; ++i) {
    largest_turn_rad = std::max(largest_turn_rad, std::abs(poses[3 * i + 2] - poses[3 * i - 1]));
  }
  EXPECT_LT(largest_turn_rad, 0.03);
  EXPECT_EQ(poses[0], 0.0);
  EXPECT_EQ(poses[1], 0.0);
}

TEST(DriveGraphTest, PosesThatWereBentComeBackToTheGraph) {
  const SlamGraph graph = StraightDrive();
  DriveGraph drive = Measured(graph);
  const std::vector<RelativePoseConstraint> closures = {
      Closure(0, kNumPoses - 1, {10.0, 0.8, 0.0})};
  std::vector<double> poses = graph.initial_poses();
  drive.Close({}, closures, graph.fixed_poses(), &poses);
  std::vector<double> bent = poses;
  for (int i = 10; i < 30; ++i) bent[3 * i + 1] += 0.3;
  // The graph stays where it is: so do the poses.
  std::vector<double> after = bent;
  drive.Close({}, closures, graph.fixed_poses(), &after);
  EXPECT_EQ(after, bent);
  // A closure that moves the graph by half a metre.
  const std::vector<RelativePoseConstraint> more = {closures[0],
                                                    Closure(0, kNumPoses / 2, {5.0, 0.8, 0.0})};
  drive.Close({}, more, graph.fixed_poses(), &after);
  drive = Measured(graph);
  std::vector<double> expected = graph.initial_poses();
  drive.Close({}, more, graph.fixed_poses(), &expected);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(after[i], expected[i], 0.01);
}

TEST(DriveGraphTest, TheOrderOfClosuresDoesNotMatter) {
  const SlamGraph graph = StraightDrive();
  const std::vector<RelativePoseConstraint> one = {Closure(0, 30, {7.5, 0.4, 0.1})},
                                            other = {Closure(5, 40, {8.75, -0.3, 0.05})},
                                            both = {one[0], other[0]};
  std::vector<std::vector<double>> results;
  for (const auto* first : {&one, &other}) {
    DriveGraph drive = Measured(graph);
    std::vector<double> poses = graph.initial_poses();
    drive.Close({}, *first, graph.fixed_poses(), &poses);
    drive.Close({}, both, graph.fixed_poses(), &poses);
    results.push_back(poses);
  }
  for (std::size_t i = 0; i < results[0].size(); ++i) {
    EXPECT_NEAR(results[0][i], results[1][i], 0.01);
  }
}

TEST(DriveGraphTest, AFalseClosureGivesWay) {
  const SlamGraph graph = StraightDrive();
  DriveGraph drive = Measured(graph);
  std::vector<double> poses = graph.initial_poses();
  std::vector<RelativePoseConstraint> closures;
  for (int i = 0; i < 4; ++i) closures.push_back(Closure(i, 30 + i, {7.5, 0.0, 0.0}));
  closures.push_back(Closure(2, 35, {4.0, 3.0, 1.0}));
  drive.Close({}, closures, graph.fixed_poses(), &poses);
  EXPECT_NEAR(poses[3 * 35], 8.75, 0.1);
  EXPECT_NEAR(poses[3 * 35 + 1], 0.0, 0.1);
}

TEST(DriveGraphTest, FixedPosesStay) {
  SlamGraph graph = StraightDrive();
  graph.FixPose(10, {2.5, 0.0, 0.0});
  graph.FixPose(20, {5.0, 0.0, 0.0});
  DriveGraph drive = Measured(graph);
  std::vector<double> poses = graph.initial_poses();
  drive.Close({}, {Closure(10, kNumPoses - 1, {7.5, 0.8, 0.0})}, graph.fixed_poses(), &poses);
  for (const int pose : {10, 20}) {
    EXPECT_NEAR(poses[3 * pose], 0.25 * pose, 1e-3);
    EXPECT_NEAR(poses[3 * pose + 1], 0.0, 1e-3);
  }
  EXPECT_GT(poses[3 * (kNumPoses - 1) + 1], 0.5);
}

TEST(DriveGraphTest, ClosuresNearByAgreeOrDoNot) {
  const DriveGraph drive = Measured(StraightDrive());
  const RelativePoseConstraint edge = Closure(2, 30, {7.0, 0.5, 0.1});
  // As the steps put it from there: one pose further at both ends, either way round.
  const Pose2 step(0.25, 0.0, 0.0);
  const Pose2 beside = step.Inverse() * edge.from_from_to * step;
  EXPECT_TRUE(drive.AgreesWithOne(edge, {Closure(3, 31, beside)}));
  const RelativePoseConstraint reversed = Closure(31, 3, beside.Inverse());
  EXPECT_TRUE(drive.AgreesWithOne(edge, {Closure(3, 31, {1.0, 0.0, 0.0}), reversed}));
  EXPECT_FALSE(drive.AgreesWithOne(edge, {Closure(3, 31, beside * Pose2(0.6, 0.0, 0.0))}));
  EXPECT_FALSE(drive.AgreesWithOne(edge, {}));
}

TEST(DriveGraphTest, WhatTheScansHoldBendsLessThanTheOdometryAlone) {
  // The first half of the drive has scans in a room, the second half none.
  NoisyRoomOptions options;
  options.num_poses = kNumPoses;
  const NoisyRoom room = MakeNoisyRoom(options);
  SlamGraph graph;
  for (int i = 0; i < kNumPoses; ++i) {
    graph.AddPose(room.truth[i], i);
    if (i > 0) {
      const Pose2 step = Between(room.truth[i - 1], room.truth[i]);
      graph.AddOdometry({i - 1, i, step});
    }
    if (i <= kNumPoses / 2) graph.AddScanOf(room.graph, i, i);
  }
  DriveGraph drive{MotionOptions()};
  drive.Extend(graph, SurfaceOf(graph));
  std::vector<double> poses = graph.initial_poses();
  drive.Measure(kNumPoses, poses);
  const int last = kNumPoses - 1, middle = kNumPoses / 2;
  const Pose2 measured = Between(room.truth[0], room.truth[last]);
  drive.Close({}, {Closure(0, last, Pose2(0.0, 0.0, 0.1) * measured)}, graph.fixed_poses(), &poses);
  const double in_room_rad = poses[3 * middle + 2] - room.truth[middle].yaw;
  const double in_all_rad = poses[3 * last + 2] - room.truth[last].yaw;
  EXPECT_GT(std::abs(in_all_rad), 0.05);
  EXPECT_LT(std::abs(in_room_rad), 0.1 * std::abs(in_all_rad));
}

}  // namespace
}  // namespace plumbline
