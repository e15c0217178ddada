#include "plumbline/solvers/seeding/rematch_at_leaps.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/seeding_testing.h"

namespace plumbline {
namespace {

// Across the room, 8 cm a step; every third scan is a key scan.
struct Crossing {
  SlamGraph graph;  // true poses
  std::vector<SurfacePoints> surfaces;
  KeyGraph keys;
  std::vector<Pose2> odometry, poses;

  double ErrorM(int pose) const { return DistanceM(poses[pose], graph.WorldFromRobot(pose)); }
  void Rematch(int num_threads) {
    ThreadPool pool(num_threads);
    RematchAtLeaps(graph, surfaces, keys, odometry, MotionOptions(), &pool, &poses);
  }
};

Crossing MakeCrossing() {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < 30; ++i) scene.poses.emplace_back(0.08 * i - 1.2, 0.2, 0.1);
  Crossing crossing;
  crossing.graph = MakeGraph(scene);
  crossing.surfaces = SurfacesOf(crossing.graph);
  crossing.poses = scene.poses;
  crossing.odometry.emplace_back();
  for (int i = 1; i < 30; ++i) {
    crossing.odometry.push_back(Between(scene.poses[i - 1], scene.poses[i]));
  }
  for (int i = 0; i < 30; i += 3) {
    KeyScan key;
    key.pose = key.scan = i;
    key.path_m = 0.08 * i;
    crossing.keys.key_scans.push_back(key);
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
