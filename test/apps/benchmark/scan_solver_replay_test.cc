#include "plumbline/apps/benchmark/scan_solver_replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// What a mapper makes of the room: edges from each node to the next, and one from the last to the
// first, which it adds with the first as source.
SlamGraph MapperGraph(const NoisyRoom& room) {
  SlamGraph graph;
  RandomStates random(9);
  const int num_poses = static_cast<int>(room.truth.size());
  const auto edge = [&](int from, int to) {
    const double yaw = random.Gaussian(0.02), y = random.Gaussian(0.02);
    RelativePoseConstraint result{
        from, to, Between(room.truth[from], room.truth[to]) * Pose2(random.Gaussian(0.02), y, yaw)};
    result.covariance = Eigen::Vector3d::Constant(4e-4).asDiagonal();
    return result;
  };
  for (int i = 0; i < num_poses; ++i) {
    // Initial guesses after the first do not count.
    const Pose2 guess = i == 0 ? room.truth[0] : Pose2(50.0, 50.0, 0.0);
    graph.AddPose(guess, 0.5 * i);
    graph.AddScanOf(room.graph, i, i);
    if (i == 0) continue;
    graph.AddRelativePose(edge(i - 1, i));
  }
  graph.AddRelativePose(edge(0, num_poses - 1));
  graph.AddRelativePose(edge(1, num_poses / 2));
  return graph;
}

TEST(ScanSolverReplayTest, ComputesAtLoopsAndEndsAtTheTruth) {
  const NoisyRoom room = MakeNoisyRoom();
  const int num_poses = static_cast<int>(room.truth.size());
  ScanSolverReplay replay;
  int num_reported = 0;
  const Status status = ReplayScanSolver(
      SolverOptions(), MapperGraph(room), [&](const ScanSolverCall&) { ++num_reported; }, &replay);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(replay.calls.size(), 2u);
  EXPECT_EQ(num_reported, 2);
  EXPECT_EQ(replay.calls[0].num_nodes, num_poses / 2 + 1);
  EXPECT_EQ(replay.calls[0].num_edges, num_poses / 2 + 1);
  EXPECT_EQ(replay.calls[1].num_nodes, num_poses);
  EXPECT_EQ(replay.calls[1].num_edges, num_poses + 1);
  EXPECT_GT(replay.calls[1].wall_s, 0.0);
  for (int i = 0; i < num_poses; ++i) {
    EXPECT_LT((replay.world_from_robot[i].translation() - room.truth[i].translation()).norm(), 0.01)
        << i;
  }
}

TEST(ScanSolverReplayTest, TableAndCsv) {
  ScanSolverReplay replay;
  replay.calls = {{10, 12, 0.1, 0.15}, {20, 25, 0.3, 0.45}};
  const std::string table = ScanSolverTable(replay);
  EXPECT_THAT(table, HasSubstr("2 computations, the last with 20 nodes and 25 edges\n"));
  EXPECT_THAT(table, HasSubstr("wall time: mean 200.0 ms, worst 300.0 ms\n"));
  EXPECT_THAT(table, HasSubstr("CPU time:  mean 300.0 ms, worst 450.0 ms\n"));
  const std::string folder = TempFolder();
  ASSERT_TRUE(WriteScanSolverCsv(folder + "calls.csv", replay).ok());
  EXPECT_EQ(ReadFile(folder + "calls.csv"),
            "nodes,edges,wall_s,cpu_s\n10,12,0.1,0.15\n20,25,0.3,0.45\n");
  EXPECT_FALSE(WriteScanSolverCsv(folder + "none/calls.csv", replay).ok());
}

TEST(ScanSolverReplayTest, RefusesWhatNoMapperMakes) {
  const NoisyRoom room = MakeNoisyRoom();
  ScanSolverReplay replay;
  SlamGraph open = room.graph;  // its closures are fine, but there is a second scan
  open.AddScanOf(room.graph, 3, 3);
  EXPECT_THAT(ReplayScanSolver(SolverOptions(), open, {}, &replay).message(),
              HasSubstr("pose 3 has several scans"));
  SlamGraph no_loop;
  for (int i = 0; i < 2; ++i) no_loop.AddPose({}, i);
  no_loop.AddRelativePose({0, 1, {1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity()});
  EXPECT_THAT(ReplayScanSolver(SolverOptions(), no_loop, {}, &replay).message(),
              HasSubstr("closes no loop"));
  SolverOptions bad;
  bad.num_threads = 0;
  EXPECT_THAT(ReplayScanSolver(bad, room.graph, {}, &replay).message(), HasSubstr("num_threads"));
  EXPECT_TRUE(replay.calls.empty());
}

}  // namespace
}  // namespace plumbline
