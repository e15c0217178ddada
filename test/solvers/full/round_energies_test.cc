#include "plumbline/solvers/full/round_energies.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

// Odometry and relative poses as measured, and poses to start from.
NoisyRoom DisturbedRoom() {
  NoisyRoom room = RoomWithEdges();
  DisturbPoses(0.03, room.graph, &room.state);
  return room;
}

std::vector<SolverOptions> EverySolver() {
  std::vector<SolverOptions> solvers;
  for (const SolverType type :
       {SolverType::kReduced, SolverType::kAlternatingCg, SolverType::kPublished,
        SolverType::kCeres, SolverType::kCeres, SolverType::kPoseGraph, SolverType::kSgd}) {
    solvers.emplace_back();
    solvers.back().type = type;
    solvers.back().ceres->reduced = solvers.size() == 5;
    solvers.back().published.max_passes = 3;
    solvers.back().rounds.max_coarse_rounds = 1;
    solvers.back().rounds.max_fine_rounds = 2;
    solvers.back().measure_rounds = true;
  }
  return solvers;
}

double EnergyOf(const SlamGraph& graph, const std::vector<double>& poses,
                const SolverOptions& options) {
  ThreadPool pool(1);
  return MarginalEnergy(graph, poses, SurfaceOf(graph), options, &pool);
}

TEST(RoundEnergiesTest, AllSolversStartAtTheSameEnergyAndEndAtThatOfTheirResult) {
  const NoisyRoom room = DisturbedRoom();
  const double start = EnergyOf(room.graph, room.state.poses, SolverOptions());
  for (const SolverOptions& options : EverySolver()) {
    MapState state = room.state;
    const SolverSummary summary = RefineState(options, room.graph, &state);
    SCOPED_TRACE(summary.solver);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    ASSERT_GE(summary.round_energies.size(), 2u);
    EXPECT_EQ(summary.round_energies[0].round, 0);
    EXPECT_EQ(summary.round_energies[0].marginal_energy, start);
    EXPECT_EQ(summary.final_marginal_energy, EnergyOf(room.graph, state.poses, options));
    // The published method has nothing to gain where scans are as sparse.
    if (options.type == SolverType::kPublished) {
      EXPECT_LE(summary.final_marginal_energy, start);
    } else {
      EXPECT_LT(summary.final_marginal_energy, start);
    }
    for (std::size_t i = 1; i < summary.round_energies.size(); ++i) {
      EXPECT_EQ(summary.round_energies[i].round, static_cast<int>(i));
    }
    EXPECT_EQ(summary.round_energies.back().iteration, static_cast<int>(summary.iterations.size()));
    EXPECT_LE(summary.round_energies.back().total_time_s, summary.total_time_s);
  }
}

TEST(RoundEnergiesTest, TheLastRoundThatWasKeptIsTheResult) {
  const NoisyRoom room = DisturbedRoom();
  for (const SolverOptions& options : EverySolver()) {
    MapState state = room.state;
    const SolverSummary summary = RefineState(options, room.graph, &state);
    SCOPED_TRACE(summary.solver);
    ASSERT_TRUE(summary.put_back.empty());
    std::size_t last = summary.round_energies.size() - 1;
    while (last > 0 && last <= summary.rounds.size() && !summary.rounds[last - 1].kept) --last;
    EXPECT_EQ(summary.round_energies[last].marginal_energy, summary.final_marginal_energy);
  }
}

TEST(RoundEnergiesTest, RoundsOfPointsHaveTheEnergyThatDecidesAboutThem) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = EverySolver()[1];
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_EQ(summary.round_energies.size(), summary.rounds.size() + 1);
  for (std::size_t i = 0; i < summary.rounds.size(); ++i) {
    EXPECT_EQ(summary.round_energies[i + 1].marginal_energy, summary.rounds[i].marginal_energy);
  }
}

TEST(RoundEnergiesTest, MeasuringChangesNothingAndIsOffByDefault) {
  const NoisyRoom room = DisturbedRoom();
  MapState plain = room.state, measured = room.state;
  SolverOptions options;
  EXPECT_TRUE(RefineState(options, room.graph, &plain).round_energies.empty());
  options.measure_rounds = true;
  int num_calls = 0;
  options.callback = [&](const IterationSummary&) { return ++num_calls > 0; };
  const SolverSummary summary = RefineState(options, room.graph, &measured);
  EXPECT_TRUE(measured == plain);
  EXPECT_EQ(num_calls, static_cast<int>(summary.iterations.size()));
}

TEST(RoundEnergiesTest, WhatTheSolverIgnoresCountsInNoRound) {
  // A wrong edge alone would raise every energy by far more than the scans can.
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = EverySolver()[0];
  MapState state = room.state;
  const double without = RefineState(options, room.graph, &state).round_energies[0].marginal_energy;
  RelativePoseConstraint wrong;
  wrong.from = 2;
  wrong.to = 9;
  wrong.from_from_to = Between(room.truth[2], room.truth[9]) * Pose2(1.5, 1.0, 0.8);
  wrong.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  room.graph.AddRelativePose(wrong);
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_EQ(summary.ignored_edges.size(), 1u);
  EXPECT_LT(summary.round_energies[0].marginal_energy, 1.01 * without);
}

TEST(RoundEnergiesTest, AGraphWithoutReturnsHasNone) {
  SlamGraph graph;
  graph.AddPose(Pose2(), 0.0);
  graph.AddPose(Pose2(1.1, 0.0, 0.0), 1.0);
  RelativePoseConstraint edge;
  edge.to = 1;
  edge.from_from_to = {1.0, 0.0, 0.0};
  graph.AddRelativePose(edge);
  SolverOptions options;
  options.type = SolverType::kPoseGraph;
  options.measure_rounds = true;
  MapState state = graph.InitialState();
  const SolverSummary summary = RefineState(options, graph, &state);
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_TRUE(summary.round_energies.empty());
}

}  // namespace
}  // namespace plumbline
