// Solve on graphs whose scans lie in several processes, against Solve on the whole graph.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/core/thread_peers.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

// Of a whole graph.
struct Part {
  SlamGraph graph;
  std::vector<int> scans;
};

Part MakePart(const SlamGraph& whole, const std::vector<int>& rank_of_pose, const Peers& peers) {
  Part part;
  for (int pose = 0; pose < whole.num_poses(); ++pose) {
    part.graph.AddPose(whole.InitialPose(pose), whole.timestamp_s(pose));
  }
  for (const FixedPose& fixed : whole.fixed_poses()) {
    if (whole.has_named_fixed_poses()) {
      part.graph.FixPose(fixed.pose, fixed.world_from_robot);
    }
  }
  for (int scan = 0; scan < whole.num_scans(); ++scan) {
    const int pose = whole.scan(scan).pose;
    if (rank_of_pose[pose] != peers.rank()) continue;
    part.graph.AddScanOf(whole, scan, pose);
    part.scans.push_back(scan);
  }
  for (const OdometryConstraint& step : whole.odometry()) {
    part.graph.AddOdometry(step);
  }
  for (const RelativePoseConstraint& edge : whole.relative_poses()) {
    part.graph.AddRelativePose(edge);
  }
  std::vector<ScanEntry> all_scans;
  for (int scan = 0; scan < whole.num_scans(); ++scan) all_scans.push_back(whole.scan(scan));
  part.graph.ShareWith(&peers, rank_of_pose, all_scans);
  return part;
}

struct Solution {
  SolverSummary summary;
  MapState state;  // of the whole graph
};

// The poses are checked to be the same in all processes.
Solution SolveShared(const SolverOptions& options, const SlamGraph& whole,
                     const std::vector<double>& poses, const std::vector<int>& rank_of_pose,
                     int num_ranks) {
  Solution solution;
  solution.state.points.resize(2 * whole.num_returns());
  std::vector<std::vector<double>> poses_of_rank(num_ranks);
  RunOnPeers(num_ranks, [&](const Peers& peers) {
    const Part part = MakePart(whole, rank_of_pose, peers);
    MapState state{poses, {}};
    const SolverSummary summary = RefineState(options, part.graph, &state);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
    poses_of_rank[peers.rank()] = state.poses;
    for (std::size_t s = 0; s < part.scans.size(); ++s) {
      const ScanEntry& entry = part.graph.scan(static_cast<int>(s));
      std::copy_n(state.points.begin() + 2 * entry.first_return, 2 * entry.num_returns,
                  solution.state.points.begin() + 2 * whole.scan(part.scans[s]).first_return);
    }
    if (peers.rank() != 0) return;
    solution.summary = summary;
    solution.state.poses = state.poses;
  });
  for (const std::vector<double>& of_rank : poses_of_rank) EXPECT_EQ(of_rank, poses_of_rank[0]);
  return solution;
}

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

SolverOptions Options() {
  SolverOptions options;
  options.num_threads = 1;
  options.test_edges = false;  // before a graph is cut into parts
  return options;
}

NoisyRoom DisturbedRoom(int num_poses) {
  NoisyRoomOptions options;
  options.num_poses = num_poses;
  NoisyRoom room = MakeNoisyRoom(options);
  DisturbPoses(0.02, room.graph, &room.state);
  return room;
}

// Stretches of poses go to the processes in turn.
std::vector<int> InTurn(int num_poses, int length, int num_ranks) {
  std::vector<int> rank_of_pose(num_poses);
  for (int pose = 0; pose < num_poses; ++pose) rank_of_pose[pose] = pose / length % num_ranks;
  return rank_of_pose;
}

class SharedSolve : public testing::TestWithParam<int> {};

TEST_P(SharedSolve, EndsWhereTheWholeGraphDoes) {
  const int num_ranks = GetParam();
  NoisyRoom room = DisturbedRoom(60);
  const SolverOptions options = Options();
  const Solution shared =
      SolveShared(options, room.graph, room.state.poses, InTurn(60, 7, num_ranks), num_ranks);
  MapState whole = room.state;
  const SolverSummary summary = RefineState(options, room.graph, &whole);
  EXPECT_EQ(summary.termination, shared.summary.termination);
  EXPECT_EQ(summary.num_points, shared.summary.num_points);
  EXPECT_NEAR(shared.summary.final_marginal_energy / summary.final_marginal_energy, 1.0, 1e-6);
  EXPECT_LT(LargestDifference(shared.state.poses, whole.poses), 1e-6);
  EXPECT_LT(LargestDifference(shared.state.points, whole.points), 1e-5);
  ASSERT_EQ(summary.landmark_rounds.size(), shared.summary.landmark_rounds.size());
  EXPECT_EQ(summary.landmark_rounds[0].num_landmarks,
            shared.summary.landmark_rounds[0].num_landmarks);
  EXPECT_NEAR(
      shared.summary.landmark_rounds[0].initial_cost / summary.landmark_rounds[0].initial_cost, 1.0,
      1e-9);
  ASSERT_EQ(summary.terms.size(), shared.summary.terms.size());
  for (std::size_t t = 0; t < summary.terms.size(); ++t) {
    EXPECT_EQ(summary.terms[t].count, shared.summary.terms[t].count) << summary.terms[t].name;
    EXPECT_NEAR(summary.terms[t].final_cost, shared.summary.terms[t].final_cost,
                1e-5 * std::max(1.0, summary.terms[t].final_cost))
        << summary.terms[t].name;
  }
  EXPECT_EQ(summary.acceptance.num_held_out, shared.summary.acceptance.num_held_out);
  EXPECT_NEAR(summary.acceptance.held_out_noise, shared.summary.acceptance.held_out_noise, 1e-6);
  EXPECT_NEAR(summary.displacements.mean_m, shared.summary.displacements.mean_m, 1e-7);
}

TEST_P(SharedSolve, HasTheSameShapeTerms) {
  const int num_ranks = GetParam();
  NoisyRoom room = DisturbedRoom(40);
  SolverOptions options = Options();
  options.factors.shape = true;
  const Solution shared =
      SolveShared(options, room.graph, room.state.poses, InTurn(40, 6, num_ranks), num_ranks);
  MapState whole = room.state;
  const SolverSummary summary = RefineState(options, room.graph, &whole);
  EXPECT_LT(LargestDifference(shared.state.poses, whole.poses), 1e-6);
  ASSERT_EQ(summary.terms.size(), shared.summary.terms.size());
  const TermSummary &shape = summary.terms.back(), &shared_shape = shared.summary.terms.back();
  ASSERT_EQ(shape.name, "shape");
  EXPECT_GT(shape.count, 1000u);
  EXPECT_EQ(shape.count, shared_shape.count);
  EXPECT_NEAR(shape.final_cost, shared_shape.final_cost, 1e-5 * shape.final_cost);
}

INSTANTIATE_TEST_SUITE_P(Ranks, SharedSolve, testing::Values(1, 2, 3, 5));

// Decisions of all have to be those of the processes with nothing, too, or they wait for ever.
TEST(SharedSolve, MoreProcessesThanScans) {
  NoisyRoom room = DisturbedRoom(6);
  SolverOptions options = Options();
  options.measure_rounds = true;
  MapState whole = room.state;
  whole.points = room.graph.MeasuredMap(whole.poses);
  const MapState seed = whole;
  const SolverSummary summary = RefineState(options, room.graph, &whole);
  RunOnParts(room.graph, 9, [&](const SlamGraph& part) {
    MapState state = PartOf(part, seed);
    const SolverSummary shared = RefineState(options, part, &state);
    ASSERT_TRUE(shared.IsSolutionUsable()) << shared.message;
    EXPECT_EQ(shared.termination, summary.termination);
    EXPECT_LT(LargestDifference(state.poses, whole.poses), 1e-6);
    ASSERT_EQ(shared.terms.size(), summary.terms.size());
    for (std::size_t t = 0; t < summary.terms.size(); ++t) {
      EXPECT_NEAR(shared.terms[t].initial_cost, summary.terms[t].initial_cost,
                  1e-6 * std::max(1.0, summary.terms[t].initial_cost))
          << summary.terms[t].name;
    }
  });
}

TEST(SharedSolve, IsTheSameEachTime) {
  NoisyRoom room = DisturbedRoom(30);
  SolverOptions options;
  options.num_threads = 1;
  const Solution once = SolveShared(options, room.graph, room.state.poses, InTurn(30, 4, 3), 3);
  options.num_threads = 2;
  const Solution again = SolveShared(options, room.graph, room.state.poses, InTurn(30, 4, 3), 3);
  EXPECT_EQ(once.state, again.state);
  EXPECT_EQ(once.summary.final_marginal_energy, again.summary.final_marginal_energy);
}

}  // namespace
}  // namespace plumbline
