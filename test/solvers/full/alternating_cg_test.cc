#include "plumbline/solvers/full/alternating_cg.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/solvers/full/ceres_solver.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

/// A noisy room whose poses are off by some centimetres, and its map prior.
struct Problem {
  Problem() {
    DisturbPoses(0.02, room.graph, &room.state);
    associations = AssociationsOf(room.graph, room.state);
  }
  InnerResult Solve(const AlternatingCgOptions& options, const ProgressCallback& report = nullptr,
                    int num_threads = 2) {
    ThreadPool pool(num_threads);
    const Energy energy(room.graph, associations, factors, &pool);
    return SolveByAlternatingCg(energy, options, report, &room.state);
  }
  double Cost() const {
    ThreadPool pool(1);
    TermCosts costs;
    EXPECT_TRUE(Energy(room.graph, associations, factors, &pool)
                    .Evaluate(room.state.poses, room.state.points, &costs));
    return costs.Total();
  }

  NoisyRoom room = MakeNoisyRoom();
  FactorOptions factors = EveryTerm();
  Associations associations;
};

AlternatingCgOptions Thorough() {
  AlternatingCgOptions options;
  options.max_sweeps = 300;
  options.relative_cost_tolerance = 1e-7;
  return options;
}

void ExpectNeverRises(const AlternatingCgOptions& options) {
  Problem problem;
  const double initial_cost = problem.Cost();
  double previous = initial_cost;
  int calls = 0;
  const InnerResult result = problem.Solve(options, [&](const IterationSummary& it) {
    EXPECT_LE(it.cost, previous * (1.0 + 1e-12)) << it.phase;
    EXPECT_GE(it.cost_change, 0.0) << it.phase;
    previous = it.cost;
    ++calls;
    return true;
  });
  EXPECT_TRUE(result.usable);
  EXPECT_EQ(result.iterations, calls);
  EXPECT_NEAR(result.initial_cost, initial_cost, 1e-12 * initial_cost);
  EXPECT_NEAR(result.final_cost, problem.Cost(), 1e-9 * initial_cost);
  EXPECT_LT(result.final_cost, 0.5 * initial_cost);
}

double CostAfterCeres() {
  Problem problem;
  CeresOptions options;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-12;
  const InnerResult result =
      SolveWithCeres(problem.room.graph, problem.associations, problem.factors, options, 2, nullptr,
                     &problem.room.state);
  EXPECT_TRUE(result.converged) << result.stop_reason;
  return problem.Cost();
}

TEST(AlternatingCgTest, CostNeverRises) { ExpectNeverRises(AlternatingCgOptions()); }

TEST(AlternatingCgTest, CostNeverRisesWithoutTheThirdTurn) {
  AlternatingCgOptions options;
  options.scan_iterations_per_sweep = 0;
  options.max_sweeps = 100;
  ExpectNeverRises(options);
}

TEST(AlternatingCgTest, ReachesTheOptimumOfLevenbergMarquardt) {
  const double optimum = CostAfterCeres();
  Problem by_default, thorough;
  AlternatingCgOptions options;
  options.max_sweeps = 30;
  by_default.Solve(options);
  EXPECT_LE(by_default.Cost(), 1.01 * optimum);
  const InnerResult result = thorough.Solve(Thorough());
  EXPECT_TRUE(result.converged) << result.stop_reason;
  EXPECT_LE(thorough.Cost(), 1.001 * optimum);
  EXPECT_GE(thorough.Cost(), (1.0 - 1e-3) * optimum);
}

// Sweeps of map and poses alone creep along what holds a pose only by way of its points.
TEST(AlternatingCgTest, DirectionsAreConjugateAndSaveSweeps) {
  AlternatingCgOptions options;
  options.scan_iterations_per_sweep = 0;
  options.max_sweeps = 30;
  options.relative_cost_tolerance = 0.0;
  Problem problem;
  int num_conjugate = 0;
  const InnerResult conjugate = problem.Solve(options, [&](const IterationSummary& it) {
    num_conjugate += it.beta > 0.0;
    return true;
  });
  EXPECT_GT(num_conjugate, conjugate.iterations / 2);
  // Started anew after each sweep there is nothing to be conjugate to.
  Problem restarted;
  options.max_sweeps = 1;
  double cost = 0.0;
  for (int sweep = 0; sweep < conjugate.iterations; ++sweep) {
    cost = restarted
               .Solve(options,
                      [](const IterationSummary& it) {
                        EXPECT_EQ(it.beta, 0.0);
                        return true;
                      })
               .final_cost;
  }
  const double gain = conjugate.initial_cost - conjugate.final_cost;
  EXPECT_LT(conjugate.final_cost, cost - 1e-3 * gain);
}

TEST(AlternatingCgTest, ASweepIsOneIteration) {
  Problem problem;
  AlternatingCgOptions options;
  options.max_sweeps = 1;
  options.scan_iterations_per_sweep = 3;
  std::vector<std::string> phases;
  const InnerResult result = problem.Solve(options, [&](const IterationSummary& it) {
    phases.push_back(it.phase);
    return true;
  });
  EXPECT_EQ(phases, std::vector<std::string>({"joint"}));
  EXPECT_FALSE(result.converged);
  EXPECT_NE(result.stop_reason.find("max_sweeps = 1"), std::string::npos) << result.stop_reason;
}

TEST(AlternatingCgTest, StopsAfterAnySweepWithTheStateThatItReports) {
  for (int stop_at = 1; stop_at <= 6; ++stop_at) {
    Problem problem;
    int calls = 0;
    double cost = 0.0;
    const InnerResult result =
        problem.Solve(AlternatingCgOptions(), [&](const IterationSummary& it) {
          cost = it.cost;
          return ++calls < stop_at;
        });
    EXPECT_TRUE(result.usable);
    EXPECT_TRUE(result.stopped);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(calls, stop_at);
    EXPECT_EQ(result.iterations, stop_at);
    EXPECT_EQ(result.final_cost, cost);
    EXPECT_NEAR(problem.Cost(), cost, 1e-9 * cost);
  }
}

TEST(AlternatingCgTest, AnyNumberOfThreadsGivesTheSameBits) {
  Problem one;
  one.Solve(AlternatingCgOptions(), nullptr, 1);
  for (const int num_threads : {2, 3, 8}) {
    Problem many;
    many.Solve(AlternatingCgOptions(), nullptr, num_threads);
    EXPECT_EQ(many.room.state, one.room.state) << num_threads;
  }
}

TEST(AlternatingCgTest, RefusesAStateWithoutAnEnergy) {
  Problem problem;
  MapState& state = problem.room.state;
  const Pose2 laser = problem.room.graph.WorldFromLaser(2, state.poses);
  const std::size_t point = problem.room.graph.scan(2).first_return;
  state.points[2 * point] = laser.x;
  state.points[2 * point + 1] = laser.y;
  const MapState given = state;
  const InnerResult result = problem.Solve(AlternatingCgOptions());
  EXPECT_FALSE(result.usable);
  EXPECT_NE(result.stop_reason.find("not finite"), std::string::npos) << result.stop_reason;
  EXPECT_EQ(state, given);
}

}  // namespace
}  // namespace plumbline
