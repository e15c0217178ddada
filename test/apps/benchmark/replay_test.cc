#include "plumbline/apps/benchmark/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/seed.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

SolverOptions Solver(int num_threads) {
  SolverOptions options;
  options.num_threads = num_threads;
  return options;
}

// A drive through a simulated building that comes back to where it was, and its seed.
struct SeededDrive {
  SlamGraph graph;
  MapState seed;
  SeedingReport report;
  std::vector<Pose2> truth;
};

const SeededDrive& Drive() {
  static const SeededDrive* drive = [] {
    auto* result = new SeededDrive;
    SimulationOptions options;
    options.scan_period_s = 0.9;
    SimulatedLog log;
    EXPECT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
    EXPECT_TRUE(MakeGraph(log, &result->graph).ok());
    for (const SimulatedScan& scan : log.scans) result->truth.push_back(scan.world_from_robot);
    ThreadPool pool(1);
    const Status status = SeedGraph(SeedingOptions(), MotionOptions(), SurfaceOf(result->graph), {},
                                    &pool, result->graph, &result->seed, &result->report);
    EXPECT_TRUE(status.ok()) << status.message();
    result->graph = std::move(result->graph).Corrected(result->report.corrections);
    return result;
  }();
  return *drive;
}

ReplayOptions SmallBatches(OnlineSolver solver) {
  ReplayOptions options;
  options.online_solver = solver;
  options.incremental.num_free_poses = 80;
  options.batch_poses = 40;
  options.window.num_free_poses = 80;
  return options;
}

Replay Replayed(OnlineSolver solver, int num_threads = 1) {
  Replay replay;
  const Status status = RunReplay(Solver(num_threads), SmallBatches(solver), Drive().graph,
                                  Drive().seed, Drive().report, {}, &replay);
  EXPECT_TRUE(status.ok()) << status.message();
  return replay;
}

class ReplayTest : public testing::TestWithParam<OnlineSolver> {};

INSTANTIATE_TEST_SUITE_P(OnlineSolvers, ReplayTest,
                         testing::Values(OnlineSolver::kIncremental, OnlineSolver::kWindow));

TEST_P(ReplayTest, EndsWhereSolvingAllAtOnceEnds) {
  const Replay replay = Replayed(GetParam());
  EXPECT_LT(std::abs(replay.online_energy / replay.batch_energy - 1.0), 0.01);
  EXPECT_LT(std::abs(replay.EnergyRatio() - 1.0), 0.01);
  for (const PoseDifferences& differences : {replay.online_difference, replay.final_difference}) {
    EXPECT_LT(differences.mean_m, 0.005);
    EXPECT_GE(differences.max_m, differences.mean_m);
    EXPECT_LT(differences.max_turn_rad, 0.01);
  }
  double worst_m = 0.0;
  const std::vector<Pose2>& truth = Drive().truth;
  ASSERT_EQ(replay.world_from_robot.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    worst_m = std::max(worst_m, (Between(truth[0], truth[i]).translation() -
                                 replay.world_from_robot[i].translation())
                                    .norm());
  }
  EXPECT_LT(worst_m, 0.05);
}

TEST_P(ReplayTest, BatchesArriveInTurnAndClosuresWhenBothEndsAreThere) {
  const std::vector<ReplayStep> steps = Replayed(GetParam()).steps;
  const int num_poses = Drive().graph.num_poses();
  ASSERT_EQ(static_cast<int>(steps.size()), (num_poses + 39) / 40 + 1);
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    EXPECT_EQ(steps[i].batch, static_cast<int>(i) + 1);
    EXPECT_EQ(steps[i].num_poses, std::min(num_poses, 40 * steps[i].batch));
    EXPECT_EQ(steps[i].solve,
              steps[i].num_news > 0 ? ReplayedSolve::kLoops : ReplayedSolve::kWindow);
    int num_closures = 0;
    for (std::size_t e = num_poses - 1; e < Drive().report.pose_graph.size(); ++e) {
      const RelativePoseConstraint& closure = Drive().report.pose_graph[e];
      if (std::max(closure.from, closure.to) < steps[i].num_poses) ++num_closures;
    }
    EXPECT_EQ(steps[i].num_closures, num_closures);
  }
  EXPECT_GT(steps.back().num_closures, 0);
  EXPECT_EQ(steps.back().solve, ReplayedSolve::kFinal);
  EXPECT_EQ(steps.back().num_poses, num_poses);
}

TEST(ReplayByWindowTest, AClosureThatIsNewsMovesEverything) {
  ReplayOptions options = SmallBatches(OnlineSolver::kWindow);
  options.max_closure_chi2 = 1e-6;  // all are
  Replay replay;
  std::vector<ReplayedSolve> seen;
  ASSERT_TRUE(RunReplay(
                  Solver(1), options, Drive().graph, Drive().seed, Drive().report,
                  [&](const ReplayStep& step) { seen.push_back(step.solve); }, &replay)
                  .ok());
  EXPECT_THAT(seen, testing::Contains(ReplayedSolve::kLoops));
  EXPECT_EQ(seen.size(), replay.steps.size());
  EXPECT_LT(std::abs(replay.EnergyRatio() - 1.0), 0.01);
}

TEST_P(ReplayTest, TheResultDoesNotDependOnTheNumberOfThreads) {
  const Replay replay = Replayed(GetParam(), 3), other = Replayed(GetParam(), 1);
  for (std::size_t i = 0; i < replay.world_from_robot.size(); ++i) {
    ASSERT_EQ(replay.world_from_robot[i].x, other.world_from_robot[i].x);
    ASSERT_EQ(replay.world_from_robot[i].y, other.world_from_robot[i].y);
    ASSERT_EQ(replay.world_from_robot[i].yaw, other.world_from_robot[i].yaw);
  }
  EXPECT_EQ(replay.batch_energy, other.batch_energy);
}

TEST(ReplayInputTest, BadInputIsNamed) {
  Replay replay;
  const auto message = [&](const ReplayOptions& options, const SlamGraph& graph,
                           const SeedingReport& report, int num_threads = 1) {
    const Status status =
        RunReplay(Solver(num_threads), options, graph, Drive().seed, report, {}, &replay);
    EXPECT_FALSE(status.ok());
    return status.message();
  };
  ReplayOptions bad;
  bad.batch_poses = 0;
  EXPECT_THAT(message(bad, Drive().graph, Drive().report), HasSubstr("batch_poses"));
  bad = ReplayOptions();
  bad.window.max_fixed_poses = -1;
  EXPECT_THAT(message(bad, Drive().graph, Drive().report), HasSubstr("window.max_fixed_poses"));
  const SlamGraph other = MakeNoisyRoom().graph;
  EXPECT_THAT(message({}, other, Drive().report), HasSubstr("report of its own seed"));
  EXPECT_THAT(message({}, SlamGraph(), SeedingReport()), HasSubstr("report of its own seed"));
  EXPECT_THAT(message({}, Drive().graph, Drive().report, 0), HasSubstr("num_threads"));
  SlamGraph unordered = Drive().graph;
  unordered.AddScanOf(unordered, 3, 3);
  EXPECT_THAT(message({}, unordered, Drive().report), HasSubstr("in the order of their poses"));
  EXPECT_TRUE(replay.steps.empty());
}

}  // namespace
}  // namespace plumbline
