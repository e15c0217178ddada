#include "plumbline/solvers/loop_closure/rematch_at_leaps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

// Across the room, by default 8 cm a step; every third scan is a keyframe.
struct Crossing {
  SlamGraph graph;  // initial guesses at the true poses
  std::vector<SurfacePoints> surfaces;
  KeyframeGraph keys;
  std::vector<Pose2> odometry, poses;

  double ErrorM(int pose) const { return DistanceM(poses[pose], graph.InitialPose(pose)); }
  void Rematch(int num_threads) {
    ThreadPool pool(num_threads);
    RematchAtLeaps(ScanSurfaces(graph, Packed(surfaces)), keys, odometry, MotionOptions(), &pool,
                   &poses);
  }
};

Crossing MakeCrossing(double step_m = 0.08) {
  const int num_poses = static_cast<int>(std::lround(2.4 / step_m));
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < num_poses; ++i) scene.poses.emplace_back(step_m * i - 1.2, 0.2, 0.1);
  Crossing crossing;
  crossing.graph = MakeGraph(scene);
  crossing.surfaces = SurfacesOf(crossing.graph);
  crossing.poses = scene.poses;
  crossing.odometry.emplace_back();
  for (int i = 1; i < num_poses; ++i) {
    crossing.odometry.push_back(Between(scene.poses[i - 1], scene.poses[i]));
  }
  for (int i = 0; i < num_poses; i += 3) {
    Keyframe key;
    key.pose = key.scan = i;
    key.path_m = step_m * i;
    crossing.keys.keyframes.push_back(key);
  }
  return crossing;
}

TEST(RematchAtLeaps, FetchesThePoseThatHangsBehind) {
  Crossing crossing = MakeCrossing();
  // The wheels stood still for a step of 0.4 m; the scan after it was matched to where they were.
  crossing.poses[14].x -= 0.4;
  crossing.poses[14].y += 0.1;
  crossing.Rematch(2);
  for (int pose = 0; pose < 30; ++pose) EXPECT_LT(crossing.ErrorM(pose), 0.02) << pose;
}

TEST(RematchAtLeaps, FetchesThePoseThatDidNotTurnAlong) {
  // The robot was carried and turned before the scan that hangs behind.
  Crossing crossing = MakeCrossing();
  crossing.poses[14].x -= 0.4;
  crossing.poses[14].yaw += 1.0;
  crossing.Rematch(2);
  for (int pose = 0; pose < 30; ++pose) EXPECT_LT(crossing.ErrorM(pose), 0.02) << pose;
}

TEST(RematchAtLeaps, FetchesASeriesThatHangsBehind) {
  // Three scans in a row were matched to where the wheels stood still, the last one 0.6 m behind.
  Crossing crossing = MakeCrossing(0.2);
  for (int pose = 5; pose <= 8; ++pose) crossing.odometry[pose] = Pose2(0.01, 0.0, 0.0);
  for (int pose = 5; pose <= 7; ++pose) {
    crossing.poses[pose] = crossing.poses[pose - 1] * crossing.odometry[pose];
  }
  EXPECT_GT(crossing.ErrorM(7), 0.55);
  crossing.Rematch(2);
  for (int pose = 0; pose < 12; ++pose) EXPECT_LT(crossing.ErrorM(pose), 0.03) << pose;
}

TEST(RematchAtLeaps, TheOdometryDecidesBetweenPosesThatFitAlmostAlike) {
  // The pose is 13 cm behind. Of the walls ahead and behind, which alone show it, the scan has a
  // few points.
  Crossing crossing = MakeCrossing(0.2);
  crossing.odometry[7] = Pose2(0.01, 0.0, 0.0);  // the wheels stood still for a step
  crossing.poses[6] = crossing.poses[6] * Pose2(-0.13, 0.0, 0.0);
  SurfacePoints thinned;
  int num_across = 0;
  for (const SurfacePoint& point : crossing.surfaces[6]) {
    const bool is_across = std::abs(point.normal.x()) > 0.7;
    if (!is_across || num_across++ % 20 == 0) thinned.push_back(point);
  }
  crossing.surfaces[6] = thinned;
  crossing.Rematch(1);
  for (int pose = 0; pose < 12; ++pose) EXPECT_LT(crossing.ErrorM(pose), 0.03) << pose;
}

TEST(RematchAtLeaps, FetchesAScanThatFitsNowhereElse) {
  // Carried by 0.8 m, unnoticed, before the scan; the odometry is right about the next step. Where
  // the scan belongs, the robot seems to have moved less evenly than where it was put.
  Crossing crossing = MakeCrossing(0.2);
  crossing.poses[6] = crossing.poses[6] * Pose2(-0.8, 0.0, 0.0);
  crossing.odometry[6] = crossing.odometry[6] * Pose2(-0.83, 0.0, 0.0);
  // Along the walls beside the robot it fits wherever they are; somebody is in the way of a third.
  SurfacePoints across;
  for (const SurfacePoint& point : crossing.surfaces[6]) {
    if (std::abs(point.normal.x()) < 0.7) continue;
    across.push_back(point);
    if (across.size() % 3 == 0) across.back().position.x() *= 0.5;
  }
  crossing.surfaces[6] = across;
  crossing.Rematch(1);
  for (int pose = 0; pose < 12; ++pose) EXPECT_LT(crossing.ErrorM(pose), 0.05) << pose;
}

TEST(RematchAtLeaps, NoPoseIsOnTheWayOverABrokenEdge) {
  // A robot that was carried 30 m between the keyframes 12 and 15. The map of what was before is
  // gone: the scans before the edge fit best into the room where it came to.
  for (const bool is_carried : {true, false}) {
    Crossing crossing = MakeCrossing();
    crossing.keys.sequential.resize(9);
    crossing.keys.sequential[4].constraint.from = 4;
    crossing.keys.sequential[4].constraint.to = 5;
    crossing.keys.sequential[4].first_pose_after = 13;  // to a pose or two
    crossing.keys.sequential[4].broken = is_carried;
    for (int pose = 14; pose < 30; ++pose) crossing.poses[pose].x += 30.0;
    for (int pose = 0; pose <= 12; pose += 3) crossing.surfaces[pose].clear();
    const std::vector<Pose2> before = crossing.poses;
    crossing.Rematch(1);
    EXPECT_EQ(crossing.poses[13].x == before[13].x, is_carried);
    for (int pose = 14; pose < 30; ++pose) EXPECT_EQ(crossing.poses[pose].x, before[pose].x);
  }
}

TEST(RematchAtLeaps, LeavesAllElseAlone) {
  Crossing crossing = MakeCrossing();
  crossing.poses[14].x -= 0.05;  // not a leap
  const std::vector<Pose2> before = crossing.poses;
  crossing.Rematch(1);
  for (int pose = 0; pose < 30; ++pose) EXPECT_EQ(crossing.poses[pose].x, before[pose].x) << pose;
  // A leap whose scans fit where they are.
  crossing.poses = MakeCrossing().poses;
  crossing.odometry[14].x += 0.5;
  crossing.Rematch(1);
  for (int pose = 0; pose < 30; ++pose) EXPECT_EQ(crossing.ErrorM(pose), 0.0) << pose;
}

}  // namespace
}  // namespace plumbline
