#include "plumbline/apps/run/packed_seed.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

// One of everything, and numbers that text would not keep.
SeedingReport MakeReport(const SlamGraph& graph) {
  const int num_poses = graph.num_poses();
  SeedingReport report;
  report.sequential.num_keyframes = 7;
  report.sequential.odometry_sign.sign_lost = true;
  report.odometry_noise.rotation = {true, 20, 0.0, 0.1 + 0.2};
  report.odometry_noise.motion.rotation_floor_rad = 5e-324;
  report.odometry_noise.clock_offset = {0.125, 1.0 / 3.0};
  report.loops.matches.push_back({1, 5, {0.1, 0.2, 0.3}, ClosureOutcome::kAmbiguous});
  report.loops.suspect_steps.push_back({5, 0.75, true, true, 0.25, 2, 3});
  WeighedHypothesis joined;
  joined.kind = HypothesisKind::kJoinedParts;
  joined.carried_to = {1.0, -2.0, 1.0 / 3.0};
  joined.first_pose_after = 4;
  joined.world_from_robot.assign(num_poses, {0.5, 0.25, 1.0 / 9.0});
  report.hypotheses = {WeighedHypothesis(), joined};
  report.consistency.worst_between = {{200, 50}, 3};
  report.consistency.places.push_back({2, 4, {0.5, -1.0 / 3.0}});
  report.pose_graph.push_back({0, 4, {1.0, 2.0, 3.0}, CorrelatedCovariance()});
  report.corrections.odometry.assign(graph.odometry().size(), {1.0 / 3.0, -0.0, 5e-324});
  report.moving_share = 1.0 / 11.0;
  report.corrections.moving_returns = {0, 7, graph.num_returns() - 1};
  report.sequential_poses.assign(num_poses, {1.0 / 7.0, 2.0, 3.0});
  report.alarm = true;
  return report;
}

TEST(PackedSeedTest, GivesBackTheSeedBitForBit) {
  const SlamGraph graph = MakeNoisyRoom().graph;
  std::vector<double> packed_poses = graph.initial_poses();
  for (double& value : packed_poses) value += 0.1;
  const SeedingReport packed = MakeReport(graph);
  const std::string bytes = PackSeed(packed_poses, packed);
  std::vector<double> poses;
  SeedingReport report;
  UnpackSeed(bytes, &poses, &report);
  EXPECT_EQ(poses, packed_poses);
  ASSERT_EQ(report.corrections.odometry.size(), graph.odometry().size());
  EXPECT_EQ(report.corrections.odometry[2].x, 1.0 / 3.0);
  EXPECT_EQ(report.corrections.moving_returns, packed.corrections.moving_returns);
  EXPECT_EQ(report.pose_graph[0].covariance, CorrelatedCovariance());
  EXPECT_EQ(report.consistency.places[0].world_point.y(), -1.0 / 3.0);
  EXPECT_EQ(report.loops.matches[0].outcome, ClosureOutcome::kAmbiguous);
  // And all the rest: packed again it is the same bytes.
  EXPECT_TRUE(PackSeed(poses, report) == bytes);
}

}  // namespace
}  // namespace plumbline
