#include "plumbline/apps/benchmark/solver_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/marginal_energy.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// Its state is the seed.
NoisyRoom Seeded() {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.03, room.graph, &room.state);
  return room;
}

// The problem of a room, measured by no relations.
ComparedProblem ProblemOf(const NoisyRoom& room) { return {room.graph, room.state, {}, {}}; }

ComparedSolver Solver(SolverType type) {
  ComparedSolver solver;
  solver.name = ToString(type);
  solver.options.type = type;
  solver.options.rounds.max_coarse_rounds = 1;
  solver.options.rounds.max_fine_rounds = 2;
  solver.options.factors.beam.sigma_range_m = 0.012;
  return solver;
}

double EnergyOf(const SlamGraph& graph, const std::vector<double>& poses,
                const SolverOptions& options) {
  ThreadPool pool(1);
  const MeasuredSurface surface =
      MeasureSurface(graph, NormalOptionsFor(options.factors.beam), &pool);
  return MarginalEnergy(graph, poses, surface, options, &pool);
}

class RunSolverWith : public testing::TestWithParam<SolverType> {};
INSTANTIATE_TEST_SUITE_P(EverySolver, RunSolverWith,
                         testing::Values(SolverType::kReduced, SolverType::kAlternatingCg,
                                         SolverType::kCeres),
                         [](const auto& info) { return ToString(info.param); });

TEST_P(RunSolverWith, TracesTheEnergyFromTheSeedToTheResult) {
  const ComparedSolver solver = Solver(GetParam());
  NoisyRoom room = Seeded();
  const SolverRun run = RunSolver(solver, ProblemOf(room), 600.0);
  std::vector<double> energies = {EnergyOf(room.graph, room.state.poses, solver.options)};
  SolverOptions options = solver.options;
  options.callback = [&](const IterationSummary& iteration) {
    energies.push_back(EnergyOf(room.graph, *iteration.poses, solver.options));
    return true;
  };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  energies.push_back(summary.final_marginal_energy);

  EXPECT_EQ(run.failure, "");
  EXPECT_EQ(run.termination, ToString(summary.termination));
  EXPECT_EQ(run.num_iterations, static_cast<int>(summary.iterations.size()));
  ASSERT_EQ(run.trace.size(), energies.size());
  for (std::size_t i = 0; i < energies.size(); ++i) {
    // Ceres adds up as threads finish.
    EXPECT_NEAR(run.trace[i].marginal_energy, energies[i], 1e-6 * energies[i]) << i;
    if (i == 0) continue;
    EXPECT_GE(run.trace[i].time_s, run.trace[i - 1].time_s);
    EXPECT_GE(run.trace[i].cpu_time_s, run.trace[i - 1].cpu_time_s);
  }
  EXPECT_EQ(run.trace[0].time_s, 0.0);
  EXPECT_LT(run.final_energy(), 0.9 * run.trace[0].marginal_energy);
  EXPECT_FALSE(run.relations.has_value());
}

TEST(SolverRunTest, AProcessOfItsOwnFindsTheSame) {
  const ComparedSolver solver = Solver(SolverType::kReduced);
  const NoisyRoom room = Seeded();
  ComparedProblem problem = ProblemOf(room);
  problem.relations.resize(1);
  problem.relations[0].to_s = 3.0;
  problem.relations[0].from_from_to =
      Between(room.state.WorldFromRobot(0), room.state.WorldFromRobot(3));
  const SolverRun here = RunSolver(solver, problem, 600.0);
  const SolverRun there = RunSolverInChild(solver, problem, 600.0);
  ASSERT_EQ(there.failure, "");
  EXPECT_EQ(there.solver, "reduced");
  EXPECT_EQ(there.termination, here.termination);
  EXPECT_EQ(there.num_rounds, here.num_rounds);
  ASSERT_EQ(there.trace.size(), here.trace.size());
  for (std::size_t i = 0; i < here.trace.size(); ++i) {
    EXPECT_EQ(there.trace[i].marginal_energy, here.trace[i].marginal_energy) << i;
  }
  ASSERT_TRUE(there.relations && here.relations);
  EXPECT_EQ(there.relations->mean_m, here.relations->mean_m);
  EXPECT_GT(there.relations->mean_m, 0.0);
  for (const auto map : {&SolverRun::raw_ranges, &SolverRun::points}) {
    ASSERT_EQ((there.*map).radii.size(), (here.*map).radii.size());
    EXPECT_EQ((there.*map).radii[1].radius_m, 0.15);
    EXPECT_EQ((there.*map).radii[1].quality.wall_thickness_m,
              (here.*map).radii[1].quality.wall_thickness_m);
  }
  EXPECT_LT(there.points.radii[1].quality.wall_thickness_m,
            there.raw_ranges.radii[1].quality.wall_thickness_m);
  EXPECT_GT(there.start_memory_bytes, std::size_t{1} << 20);
  EXPECT_GE(there.peak_memory_bytes, there.start_memory_bytes / 2);
}

TEST(SolverRunTest, TheTimeLimitStopsASolver) {
  const NoisyRoom room = Seeded();
  const SolverRun run = RunSolver(Solver(SolverType::kAlternatingCg), ProblemOf(room), 1e-9);
  EXPECT_EQ(run.failure, "");
  EXPECT_EQ(run.termination, ToString(TerminationType::kUserStopped));
  EXPECT_EQ(run.num_iterations, 1);
}

// Asks no callback whether to go on.
class EndlessSolver final : public plumbline::Solver {
 public:
  const char* name() const override { return "endless"; }
  SolverSummary Solve(const SolverProblem&, MapState*) const override {
    while (true) std::this_thread::sleep_for(std::chrono::seconds(1));
  }
};

TEST(SolverRunTest, ASolverThatDoesNotStopIsKilled) {
  ComparedSolver endless;
  endless.options.own_solver = std::make_shared<EndlessSolver>();
  EXPECT_EQ(RunSolverInChild(endless, ProblemOf(Seeded()), 1e-9).failure,
            "did not stop within twice its time limit");
}

TEST(SolverRunTest, FailuresAreTold) {
  const NoisyRoom room = Seeded();
  ComparedSolver bad = Solver(SolverType::kReduced);
  bad.options.rounds.fine_radius_m = -1.0;
  EXPECT_THAT(RunSolverInChild(bad, ProblemOf(room), 600.0).failure, HasSubstr("fine_radius_m"));
}

}  // namespace
}  // namespace plumbline
