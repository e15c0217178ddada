// A host's own minimiser behind Solve: all of it is in this file.

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "plumbline/solvers/full/rounds_solver.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/sliding_window.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

// Steps along the gradient, each coordinate divided by its own curvature.
class DiagonalDescent final : public RoundsSolver {
 public:
  const char* name() const override { return "diagonal_descent"; }

  InnerResult Minimize(const RoundProblem& problem, const ProgressCallback& report,
                       MapState* state) const override {
    InnerResult result;
    TermCosts costs;
    result.usable = problem.energy.Evaluate(state->poses, state->points, &costs);
    result.initial_cost = result.final_cost = costs.Total();
    double length = 0.5;
    while (result.usable && !result.stopped && result.iterations < 100 && length > 1e-3) {
      const MapState next = Moved(problem.energy, length, *state);
      const bool lower = problem.energy.Evaluate(next.poses, next.points, &costs) &&
                         costs.Total() < result.final_cost;
      length *= lower ? 1.2 : 0.5;
      if (!lower) continue;
      *state = next;
      IterationSummary iteration;
      iteration.phase = "joint";
      iteration.cost = costs.Total();
      iteration.cost_change = result.final_cost - iteration.cost;
      result.final_cost = iteration.cost;
      ++result.iterations;
      result.stopped = report && !report(iteration);
    }
    result.stop_reason = "no step of a useful length, or a hundred of them";
    return result;
  }

 private:
  // `blocks` are the upper triangles, row by row, of an n x n matrix for every n coordinates.
  static void Step(const std::vector<double>& gradient, const std::vector<double>& blocks, int n,
                   double length, std::vector<double>* x) {
    const int block_size = n * (n + 1) / 2;
    for (std::size_t i = 0; i < x->size(); ++i) {
      const int k = static_cast<int>(i % n);
      const double curvature = blocks[block_size * (i / n) + k * n - k * (k - 1) / 2];
      if (curvature > 0.0) (*x)[i] -= length * gradient[i] / curvature;
    }
  }

  static MapState Moved(const Energy& energy, double length, const MapState& from) {
    std::vector<double> poses, points, pose_blocks, point_blocks;
    TermCosts costs;
    energy.Evaluate(from.poses, from.points, &costs,
                    {&poses, &points, &pose_blocks, &point_blocks});
    for (int i = 0; i < 3; ++i) poses[i] = 0.0;  // the first pose stays
    MapState to = from;
    Step(poses, pose_blocks, 3, length, &to.poses);
    Step(points, point_blocks, 2, length, &to.points);
    return to;
  }
};

// Draws all points to the origin, and calls that an improvement.
class Collapse final : public RoundsSolver {
 public:
  const char* name() const override { return "collapse"; }
  InnerResult Minimize(const RoundProblem&, const ProgressCallback&,
                       MapState* state) const override {
    for (double& coordinate : state->poses) coordinate *= 0.5;
    for (double& coordinate : state->points) coordinate = 0.0;
    InnerResult result;
    result.usable = result.converged = true;
    result.stop_reason = "collapsed";
    return result;
  }
};

class Thrower final : public RoundsSolver {
 public:
  const char* name() const override { return "thrower"; }
  InnerResult Minimize(const RoundProblem&, const ProgressCallback&, MapState*) const override {
    throw std::runtime_error("out of ideas");
  }
};

template <typename OwnSolver>
SolverOptions OptionsWith() {
  SolverOptions options;
  options.own_solver = std::make_shared<OwnSolver>();
  options.rounds.max_coarse_rounds = 1;
  options.rounds.max_fine_rounds = 3;
  return options;
}

NoisyRoom DisturbedRoom() {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.03, room.graph, &room.state);
  return room;
}

TEST(OwnSolver, IsRunInRoundsAndPassesTheAcceptanceTest) {
  NoisyRoom room = DisturbedRoom();
  const double before_m = MeanPoseError(room);
  const SolverSummary summary =
      RefineState(OptionsWith<DiagonalDescent>(), room.graph, &room.state);
  EXPECT_TRUE(summary.acceptance.IsBetter()) << summary.message;
  EXPECT_EQ(summary.solver, "diagonal_descent");
  EXPECT_LT(MeanPoseError(room), 0.8 * before_m);
  ASSERT_GT(summary.rounds.size(), 1u);
  int iterations = 0;
  for (const RoundSummary& round : summary.rounds) iterations += round.iterations;
  ASSERT_EQ(static_cast<int>(summary.iterations.size()), iterations);
  EXPECT_EQ(summary.iterations.back().iteration, iterations);
  EXPECT_EQ(summary.iterations.back().round, static_cast<int>(summary.rounds.size()));
}

TEST(OwnSolver, GivesTheSeedBackBitForBitIfItsResultIsWorse) {
  NoisyRoom room = DisturbedRoom();
  const MapState seed = room.state;
  const SolverSummary summary = RefineState(OptionsWith<Collapse>(), room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kNoImprovement);
  EXPECT_EQ(room.state.poses, seed.poses);
  EXPECT_EQ(room.state.points, seed.points);
}

TEST(OwnSolver, StopsWhenTheCallbackAsks) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = OptionsWith<DiagonalDescent>();
  options.callback = [](const IterationSummary& it) { return it.iteration < 5; };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.iterations.size(), 5u);
  EXPECT_TRUE(summary.IsSolutionUsable());
}

TEST(OwnSolver, WhatItThrowsIsAFailure) {
  NoisyRoom room = DisturbedRoom();
  const MapState seed = room.state;
  const SolverSummary summary = RefineState(OptionsWith<Thrower>(), room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_EQ(summary.solver, "thrower");
  EXPECT_NE(summary.message.find("out of ideas"), std::string::npos) << summary.message;
  EXPECT_EQ(room.state.poses, seed.poses);
}

TEST(OwnSolver, SolvesWindowsAsWell) {
  NoisyRoom room = DisturbedRoom();
  WindowOptions window;
  window.num_free_poses = 6;
  const SolverSummary summary =
      SolveWindow(OptionsWith<DiagonalDescent>(), window, room.graph, &room.state);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_EQ(summary.solver, "diagonal_descent");
}

}  // namespace
}  // namespace plumbline
