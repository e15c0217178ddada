#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/solvers/solve.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

SolverOptions Published() {
  SolverOptions options;
  options.type = SolverType::kPublished;
  options.published.max_passes = 12;
  return options;
}

NoisyRoom DisturbedRoom() {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.02, room.graph, &room.state);
  return room;
}

TEST(PublishedMethodTest, MovesMapAndPosesInTurnAlongConjugateDirections) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = Published();
  options.published.sweeps_per_pass = 2;
  options.published.relative_tolerance = 0.0;
  const SolverSummary summary = Solve(options, room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  ASSERT_EQ(summary.rounds.size(), 12u);
  ASSERT_EQ(summary.iterations.size(), 48u);
  int num_conjugate = 0;
  for (std::size_t i = 0; i < summary.iterations.size(); ++i) {
    const IterationSummary& iteration = summary.iterations[i];
    EXPECT_EQ(iteration.phase, i % 2 == 0 ? "map" : "poses") << i;
    EXPECT_GE(iteration.cost_change, 0.0) << i;
    num_conjugate += iteration.beta > 0.0;
  }
  // All but the first of each kind, and where a direction was no descent.
  EXPECT_GT(num_conjugate, 36);
  EXPECT_EQ(summary.iterations[0].beta, 0.0);
  EXPECT_EQ(summary.iterations[1].beta, 0.0);
}

TEST(PublishedMethodTest, EveryPointHasATangentLineAndSegmentsHavePairs) {
  NoisyRoom room = DisturbedRoom();
  const SolverSummary summary = Solve(Published(), room.graph, &room.state);
  ASSERT_FALSE(summary.rounds.empty());
  for (const RoundSummary& pass : summary.rounds) {
    EXPECT_EQ(pass.num_lines, room.graph.num_returns());
    EXPECT_GT(pass.num_shape_pairs, 20u);
    EXPECT_LE(pass.final_cost, pass.initial_cost);
    EXPECT_TRUE(pass.kept);
  }
  ASSERT_EQ(summary.terms.size(), 5u);
  EXPECT_EQ(summary.terms[3].name, "manifold");
  EXPECT_EQ(summary.terms[3].count, room.graph.num_returns());
  EXPECT_EQ(summary.terms[4].name, "shape");
  EXPECT_GT(summary.terms[4].final_cost, 0.0);
}

TEST(PublishedMethodTest, ReportsTheAcceptanceTestAndDoesNotApplyIt) {
  // From the truth, with noise as it is, every step away is a step for the worse.
  NoisyRoom room = MakeNoisyRoom();
  const MapState seed = room.state;
  const SolverSummary summary = Solve(Published(), room.graph, &room.state);
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_NE(summary.termination, TerminationType::kNoImprovement);
  EXPECT_GT(summary.acceptance.num_held_out, 10u);
  EXPECT_FALSE(room.state == seed);
  EXPECT_THAT(summary.put_back, testing::IsEmpty());
  EXPECT_THAT(summary.downweighted_steps, testing::IsEmpty());
  EXPECT_FALSE(summary.started_from_constraints);
}

TEST(PublishedMethodTest, PassesEndWhenOneGainsLittle) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = Published();
  options.published.relative_tolerance = 0.5;
  const SolverSummary summary = Solve(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kConverged) << summary.message;
  EXPECT_LT(summary.rounds.size(), 12u);
  const RoundSummary& last = summary.rounds.back();
  EXPECT_LE(last.initial_cost - last.final_cost, 0.5 * last.initial_cost);
}

// Each pass has another energy, and needs the preconditioner of that.
TEST(PublishedMethodTest, IsFasterWithAPreconditioner) {
  double gain[2];
  for (const bool precondition : {false, true}) {
    NoisyRoom room = DisturbedRoom();
    SolverOptions options = Published();
    options.published.precondition = precondition;
    options.published.max_passes = 4;
    options.published.relative_tolerance = 0.0;
    const SolverSummary summary = Solve(options, room.graph, &room.state);
    ASSERT_EQ(summary.rounds.size(), 4u);
    gain[precondition] = summary.acceptance.seed_energy - summary.acceptance.final_energy;
    for (const IterationSummary& iteration : summary.iterations) {
      EXPECT_GT(iteration.cost_change, 0.0);
    }
  }
  EXPECT_GT(gain[true], 1.2 * gain[false]);
  EXPECT_GT(gain[true], 0.0);
}

TEST(PublishedMethodTest, StopsWhenTheCallbackSaysSo) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = Published();
  int calls = 0;
  options.callback = [&](const IterationSummary&) { return ++calls < 5; };
  const SolverSummary summary = Solve(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped);
  EXPECT_EQ(calls, 5);
}

}  // namespace
}  // namespace plumbline
