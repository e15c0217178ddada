#include "plumbline/solvers/reduced/reduced_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/terms/pose_terms.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

NoisyRoom DisturbedRoom(int num_poses = 12, double sigma = 0.02) {
  NoisyRoomOptions options;
  options.num_poses = num_poses;
  NoisyRoom room = MakeNoisyRoom(options);
  DisturbPoses(sigma, room.graph, &room.state);
  return room;
}

ReducedResult Minimize(NoisyRoom* room, const ReducedOptions& options = ReducedOptions(),
                       const ProgressCallback& report = nullptr, int num_threads = 2) {
  ThreadPool pool(num_threads);
  return MinimizeOverLandmarks(room->graph, SurfaceOf(room->graph), FactorOptions(), options,
                               AssociationOptions(), report, &pool, &room->state.poses);
}

TEST(ReducedSolverTest, BringsThePosesCloserToTheTruth) {
  NoisyRoom room = DisturbedRoom(24);
  const double before_m = MeanPoseError(room);
  const ReducedResult result = Minimize(&room);
  EXPECT_LT(MeanPoseError(room), 0.4 * before_m);
  EXPECT_TRUE(result.converged) << result.stop_reason;
  EXPECT_FALSE(result.stopped);
  EXPECT_THAT(result.stop_reason, HasSubstr("within the tolerances"));
}

TEST(ReducedSolverTest, RoundsTellWhatTheyDid) {
  NoisyRoom room = DisturbedRoom(24);
  ReducedOptions options;
  std::vector<IterationSummary> rows;
  const ReducedResult result = Minimize(&room, options, [&](const IterationSummary& row) {
    rows.push_back(row);
    return true;
  });
  ASSERT_GE(result.rounds.size(), 2u);
  ASSERT_EQ(rows.size(), result.rounds.size());
  const double gate = FactorOptions().manifold.robust_gate_sigmas;
  for (std::size_t i = 0; i < result.rounds.size(); ++i) {
    const LandmarkRoundSummary& round = result.rounds[i];
    EXPECT_DOUBLE_EQ(round.gate_sigmas, i == 0 ? kStartGateFactor * gate : gate);
    EXPECT_GT(round.num_landmarks, 10u);
    EXPECT_GE(round.num_observations, 2 * round.num_landmarks);
    EXPECT_GT(round.final_cost, 0.0);
    const IterationSummary& row = rows[i];
    EXPECT_EQ(row.round, static_cast<int>(i) + 1);
    EXPECT_GE(row.cost_change, 0.0);
    EXPECT_LE(row.step_size, 1.0);
    EXPECT_EQ(row.step_size > 0.0, row.cost_change > 0.0);
    EXPECT_GT(row.evaluations, 0);
    EXPECT_NEAR(round.initial_cost, row.cost + row.cost_change, 1e-9 * round.initial_cost);
    EXPECT_EQ(round.final_cost, row.cost);
  }
  EXPECT_GT(result.rounds.front().moved_sigmas, 0.5);
  EXPECT_LE(result.rounds.back().moved_sigmas, 0.1);
  EXPECT_LT(result.rounds.back().final_cost, result.rounds.front().initial_cost);
}

TEST(ReducedSolverTest, NoStepRaisesTheCostHoweverFarTheSeedIs) {
  for (const double sigma : {0.1, 0.5, 1.5, 5.0, 20.0}) {
    NoisyRoom room = DisturbedRoom(16, sigma);
    Minimize(&room, ReducedOptions(), [&](const IterationSummary& row) {
      EXPECT_GE(row.cost_change, 0.0);
      return true;
    });
  }
}

TEST(ReducedSolverTest, TheEndIsWhereAnotherStartEnds) {
  // From 1 cm and from 3 cm off: what differs is what the noise of the landmarks' edges leaves
  // open.
  NoisyRoom near = DisturbedRoom(24, 0.01), far = DisturbedRoom(24, 0.03);
  ReducedOptions options;
  options.max_rounds = 30;
  options.relative_tolerance = 1e-5;
  Minimize(&near, options);
  Minimize(&far, options);
  for (int i = 0; i < near.state.num_poses(); ++i) {
    const Pose2 a = near.state.WorldFromRobot(i), b = far.state.WorldFromRobot(i);
    EXPECT_LT((a.translation() - b.translation()).norm(), 0.005) << i;
    EXPECT_NEAR(a.yaw, b.yaw, 0.003) << i;
  }
}

TEST(ReducedSolverTest, TheLimitOfRoundsHolds) {
  NoisyRoom room = DisturbedRoom();
  ReducedOptions options;
  options.max_rounds = 2;
  options.relative_tolerance = 0.0;
  const ReducedResult result = Minimize(&room, options);
  ASSERT_EQ(result.rounds.size(), 3u);  // and one with the held-out returns
  EXPECT_FALSE(result.converged);
}

TEST(ReducedSolverTest, TheCallbackStopsAfterTheStepItSaw) {
  for (const int last : {1, 2, 3}) {
    NoisyRoom room = DisturbedRoom();
    int calls = 0;
    const ReducedResult result =
        Minimize(&room, ReducedOptions(), [&](const IterationSummary&) { return ++calls < last; });
    EXPECT_EQ(calls, last);
    EXPECT_TRUE(result.stopped);
    EXPECT_THAT(result.stop_reason, HasSubstr("callback"));
    EXPECT_EQ(static_cast<int>(result.rounds.size()), last);
  }
}

TEST(ReducedSolverTest, WithoutSurfacesTheOdometryRules) {
  NoisyRoom room = DisturbedRoom();
  MeasuredSurface blind = SurfaceOf(room.graph);
  for (ReturnNormal& normal : blind.normals) normal = {};
  ThreadPool pool(2);
  ReducedOptions options;
  options.relative_tolerance = 1e-12;
  const ReducedResult result =
      MinimizeOverLandmarks(room.graph, blind, FactorOptions(), options, AssociationOptions(),
                            nullptr, &pool, &room.state.poses);
  EXPECT_TRUE(result.converged) << result.stop_reason;
  EXPECT_EQ(result.rounds.front().num_landmarks, 0u);
  // A minimum of the pose terms: no coordinate can be moved to lower them.
  const PoseTerms terms(room.graph, FactorOptions());
  const double cost = terms.Cost(room.state.poses);
  EXPECT_NEAR(result.rounds.back().final_cost, cost, 1e-9 * cost);
  for (std::size_t i = 0; i < room.state.poses.size(); ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      std::vector<double> poses = room.state.poses;
      poses[i] += step;
      EXPECT_GT(terms.Cost(poses), cost);
    }
  }
}

TEST(ReducedSolverTest, AnyNumberOfThreadsGivesTheSameBits) {
  NoisyRoom one = DisturbedRoom(150);
  const ReducedResult expected = Minimize(&one, ReducedOptions(), nullptr, 1);
  EXPECT_GT(expected.rounds.front().num_observations, 1000u);
  for (const int num_threads : {2, 3, 8}) {
    NoisyRoom many = DisturbedRoom(150);
    const ReducedResult result = Minimize(&many, ReducedOptions(), nullptr, num_threads);
    EXPECT_EQ(many.state.poses, one.state.poses);
    ASSERT_EQ(result.rounds.size(), expected.rounds.size());
    EXPECT_EQ(result.rounds.back().final_cost, expected.rounds.back().final_cost);
  }
}

}  // namespace
}  // namespace plumbline
