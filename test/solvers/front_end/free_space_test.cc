#include "plumbline/solvers/front_end/free_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

FreeSpaceConflict OneWay(const SlamGraph& graph, int viewer, int scan,
                         const Pose2& viewer_from_scan) {
  return FreeSpaceScan(graph, viewer)
      .Compare(FreeSpaceScan(graph, scan), viewer_from_scan, nullptr);
}

TEST(FreeSpace, TwoViewsOfOneRoomAgree) {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  scene.poses = {Pose2(), Pose2(0.8, -0.5, 0.7)};
  const SlamGraph graph = MakeGraph(scene);
  const FreeSpaceConflict conflict = OneWay(graph, 0, 1, scene.poses[1]);
  EXPECT_GT(conflict.num_compared, 250);
  EXPECT_LT(conflict.Share(), 0.01);
}

TEST(FreeSpace, AWallInTheMiddleOfARoomConflicts) {
  // The viewer sees a room of 6 m x 6 m; the scan one of 3 m x 3 m. Every return of the small room
  // is 1.5 m in front of the large one's walls.
  SyntheticScene large, small;
  large.faces = Rectangle({-3.0, -3.0}, {3.0, 3.0});
  small.faces = Rectangle({98.5, -1.5}, {101.5, 1.5});
  large.faces.insert(large.faces.end(), small.faces.begin(), small.faces.end());
  large.poses = {Pose2(), Pose2(100.0, 0.0, 0.0)};
  const SlamGraph graph = MakeGraph(large);
  const FreeSpaceConflict seen_through = OneWay(graph, 0, 1, Pose2());
  EXPECT_GT(seen_through.num_compared, 300);
  EXPECT_EQ(seen_through.num_conflicting, seen_through.num_compared);
  // The other way round the large room is hidden behind the small one's walls.
  EXPECT_EQ(OneWay(graph, 1, 0, Pose2()).num_compared, 0);
}

TEST(FreeSpace, WhatTheGraphKnowsToMoveIsNotCompared) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.8, -0.5, 0.7)};
  const SlamGraph graph = MakeGraph(scene);
  MeasurementCorrections corrections;
  const ScanEntry& viewed = graph.scan(1);
  for (std::size_t i = 0; i < viewed.num_returns / 2; ++i) {
    corrections.moving_returns.push_back(viewed.first_return + i);
  }
  const int all = OneWay(graph, 0, 1, scene.poses[1]).num_compared;
  const SlamGraph marked = graph.Corrected(corrections);
  EXPECT_LT(OneWay(marked, 0, 1, scene.poses[1]).num_compared, 0.7 * all);
  EXPECT_GT(OneWay(marked, 0, 1, scene.poses[1]).num_compared, 0.3 * all);
}

TEST(FreeSpace, TheSweepMayBeginAnywhereAndTurnEitherWay) {
  for (const double first_bearing_rad : {0.0, 0.5 * kPi, -2.0 * kPi, 2.0 * kPi}) {
    for (const double direction : {1.0, -1.0}) {
      SyntheticScene scene = Room();
      scene.laser.first_bearing_rad = first_bearing_rad;
      scene.laser.bearing_step_rad *= direction;
      scene.poses = {Pose2(), Pose2(0.8, -0.5, 0.7)};
      const SlamGraph graph = MakeGraph(scene);
      EXPECT_GT(OneWay(graph, 0, 1, scene.poses[1]).num_compared, 250)
          << first_bearing_rad << " " << direction;
    }
  }
}

TEST(FreeSpace, LasersOfManyAndOfFewBeamsCompareAsMuch) {
  for (const double per_deg : {1.0, 2.0, 4.0}) {
    SyntheticScene scene = Room();
    scene.laser = PanoramicLaser(static_cast<int>(360 * per_deg));
    scene.poses = {Pose2(), Pose2(0.8, -0.5, 0.7)};
    const SlamGraph graph = MakeGraph(scene);
    EXPECT_NEAR(OneWay(graph, 0, 1, scene.poses[1]).num_compared, 340, 20) << per_deg;
  }
}

TEST(FreeSpace, ALaserOfOneBeamSeesNoArea) {
  SyntheticScene scene = Room();
  scene.laser.num_beams = 1;
  scene.laser.bearing_step_rad = 0.0;
  scene.poses = {Pose2(), Pose2(0.1, 0.0, 0.0)};
  EXPECT_EQ(OneWay(MakeGraph(scene), 0, 1, scene.poses[1]).num_compared, 0);
}

TEST(FreeSpace, EveryReturnHasAVerdict) {
  // The viewer sees a room of 6 m x 6 m; the scan the same walls, one 1.5 m ahead, and one 2 m
  // behind the walls to the left.
  SyntheticScene scene;
  scene.faces = Rectangle({-3.0, -3.0}, {3.0, 3.0});
  scene.faces.push_back({{101.5, -1.0}, {101.5, 1.0}});
  scene.faces.push_back({{99.0, 5.0}, {101.0, 5.0}});
  scene.faces.push_back({{97.0, -1.0}, {97.0, 1.0}});
  scene.poses = {Pose2(), Pose2(100.0, 0.0, 0.0)};
  scene.laser.max_range_m = 20.0;
  const SlamGraph graph = MakeGraph(scene);
  const FreeSpaceScan viewer(graph, 0), scan(graph, 1);
  ComparedReturns compared;
  const FreeSpaceConflict conflict = viewer.Compare(scan, Pose2(), &compared);
  ASSERT_EQ(compared.verdicts.size(), scan.returns().size());
  int counts[3] = {};
  for (std::size_t i = 0; i < compared.verdicts.size(); ++i) {
    const Eigen::Vector2d& point = scan.returns()[i];
    // The room, from far away, or where the sweep begins.
    if (point.x() < -90.0 || (point.x() < -2.9 && std::abs(point.y()) < 0.1)) continue;
    const ReturnVerdict expected = point.y() > 4.0    ? ReturnVerdict::kNotCompared
                                   : point.x() < -2.9 ? ReturnVerdict::kAgrees
                                                      : ReturnVerdict::kConflicts;
    EXPECT_EQ(compared.verdicts[i], expected) << point.transpose();
    ++counts[static_cast<int>(expected)];
  }
  for (const int count : counts) EXPECT_GT(count, 10);
  EXPECT_EQ(conflict.num_conflicting, counts[2]);
}

TEST(FreeSpace, MovingReturnsAreCountedApart) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.8, -0.5, 0.7)};
  const SlamGraph graph = MakeGraph(scene);
  const FreeSpaceScan viewer(graph, 0);
  FreeSpaceScan scan(graph, 1);
  ComparedReturns before, after;
  const FreeSpaceConflict all = viewer.Compare(scan, scene.poses[1], &before);
  EXPECT_EQ(before.with_moving.num_compared, all.num_compared);
  const auto first_seen =
      std::find(before.verdicts.begin(), before.verdicts.end(), ReturnVerdict::kAgrees);
  ASSERT_NE(first_seen, before.verdicts.end());
  const auto place = first_seen - before.verdicts.begin();
  scan.MarkMoving({static_cast<int>(place)});
  EXPECT_EQ(viewer.Compare(scan, scene.poses[1], &after).num_compared, all.num_compared - 1);
  EXPECT_EQ(after.with_moving.num_compared, all.num_compared);
  before.verdicts[place] = ReturnVerdict::kNotCompared;
  EXPECT_EQ(after.verdicts, before.verdicts);
  scan.MarkMoving({});  // on top of that
  EXPECT_EQ(viewer.Compare(scan, scene.poses[1], nullptr).num_compared, all.num_compared - 1);
}

TEST(FreeSpace, BothWaysIsTheSumOfTheTwo) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.8, -0.5, 0.7)};
  scene.laser = PanoramicLaser(360);
  const SlamGraph graph = MakeGraph(scene);
  // A metre ahead of where it was taken, the second scan conflicts with the first one.
  const Pose2 first_from_second = scene.poses[1] * Pose2(1.0, 0.0, 0.0);
  const FreeSpaceConflict there = OneWay(graph, 0, 1, first_from_second);
  const FreeSpaceConflict back = OneWay(graph, 1, 0, first_from_second.Inverse());
  EXPECT_GT(there.num_conflicting, 20);
  EXPECT_GT(back.num_conflicting, 20);
  const FreeSpaceConflict both =
      CompareBothWays(FreeSpaceScan(graph, 0), FreeSpaceScan(graph, 1), first_from_second);
  EXPECT_EQ(both.num_compared, there.num_compared + back.num_compared);
  EXPECT_EQ(both.num_conflicting, there.num_conflicting + back.num_conflicting);
}

TEST(FreeSpace, SumsAndShares) {
  FreeSpaceConflict sum{10, 1};
  sum += {30, 9};
  EXPECT_EQ(sum.Share(), 0.25);
  sum -= {30, 9};
  EXPECT_EQ(sum.Share(), 0.1);
  EXPECT_EQ(FreeSpaceConflict().Share(), 0.0);
  EXPECT_EQ((FreeSpaceConflict{400, 100}.Penalty()), 0.75);
}

}  // namespace
}  // namespace plumbline
