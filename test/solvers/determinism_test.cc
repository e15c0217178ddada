// The same input gives the same bytes: over repeats, for any number of threads, and whatever
// floating-point environment the host has set.

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/covariance.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/seed.h"
#include "plumbline/solvers/sliding_window.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/test/core/host_float_environment.h"

namespace plumbline {
namespace {

constexpr SolverType kSolvers[] = {SolverType::kReduced, SolverType::kAlternatingCg,
                                   SolverType::kPublished, SolverType::kPoseGraph,
                                   SolverType::kSgd};

// The first metres of a drive through an office, as a host has it before it calls the library.
const SlamGraph& ShortLog() {
  static const SlamGraph graph = [] {
    constexpr int kNumScans = 30;
    SimulationOptions options;
    options.scan_period_s = 0.5;
    SimulatedLog log;
    SlamGraph made;
    const World world(GenerateBuilding(BuildingKind::kRandom, 1));
    EXPECT_TRUE(Simulate(world, options, &log).ok());
    log.scans.resize(kNumScans);
    EXPECT_TRUE(MakeGraph(log, &made).ok());
    return made;
  }();
  return graph;
}

// All that comes out of a run.
struct Result {
  std::vector<double> seed_poses, poses, points, figures;
};

// Doubles that compare equal may differ in their bytes, and NaN is not even equal to itself.
bool SameBytes(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}
void ExpectSame(const Result& a, const Result& b, const std::string& what) {
  EXPECT_TRUE(SameBytes(a.seed_poses, b.seed_poses)) << what << ", seed";
  EXPECT_TRUE(SameBytes(a.poses, b.poses)) << what << ", poses";
  EXPECT_TRUE(SameBytes(a.points, b.points)) << what << ", points";
  EXPECT_TRUE(SameBytes(a.figures, b.figures)) << what << ", energies";
}

// A graph, with its odometry corrected, and its seed.
struct SeededGraph {
  SlamGraph graph;
  MapState state;
};

SeededGraph Seeded(int num_threads) {
  SeededGraph seeded;
  ThreadPool pool(num_threads);
  const FactorOptions factors;
  const MeasuredSurface surface = MeasureSurface(ShortLog(), NormalOptionsFor(factors.beam), &pool);
  SeedingReport report;
  EXPECT_TRUE(SeedGraph(SeedingOptions(), factors.motion, surface, {}, &pool, ShortLog(),
                        &seeded.state, &report)
                  .ok());
  seeded.graph = ShortLog().Corrected(report.corrections);
  // For those solvers that know nothing else; the last edge contradicts the others a little.
  for (const RelativePoseConstraint& edge : report.pose_graph) {
    seeded.graph.AddRelativePose(edge);
  }
  RelativePoseConstraint edge = report.pose_graph.back();
  edge.from_from_to.y = 0.01;  // no sum, which the host's rounding would be part of
  seeded.graph.AddRelativePose(edge);
  return seeded;
}

// From one and the same seed.
Result RunSolver(SolverType type, const SeededGraph& seeded, int num_threads) {
  MapState state = seeded.state;
  {
    const DefaultFloatEnvironment plain;  // these sums are not what is tested
    for (std::size_t i = 3; i < state.poses.size(); i += 6) state.poses[i] += 0.01;
    state.points = seeded.graph.MeasuredMap(state.poses);
  }
  Result result;
  result.seed_poses = state.poses;
  SolverOptions options;
  options.type = type;
  options.published.max_passes = 2;
  options.num_threads = num_threads;
  // Enough to come through every line of them.
  options.rounds.max_coarse_rounds = options.rounds.max_fine_rounds = 1;
  options.alternating_cg.max_sweeps = 2;
  const SolverSummary summary = RefineState(options, seeded.graph, &state);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_FALSE(SameBytes(result.seed_poses, state.poses))
      << summary.solver << ": " << summary.message;
  result.poses = state.poses;
  result.points = state.points;
  result.figures = {summary.final_marginal_energy, summary.acceptance.seed_energy,
                    summary.acceptance.final_energy};
  return result;
}

// By solver: the seeding, and all of them from its seed.
std::vector<Result> RunAll(int num_threads) {
  const SeededGraph seeded = Seeded(num_threads);
  std::vector<Result> results;
  for (const SolverType type : kSolvers) results.push_back(RunSolver(type, seeded, num_threads));
  return results;
}

void ExpectSame(const std::vector<Result>& a, const std::vector<Result>& b,
                const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ExpectSame(a[i], b[i], ToString(kSolvers[i]) + (", " + what));
  }
}

TEST(Determinism, AnyNumberOfThreads) {
  const std::vector<Result> expected = RunAll(1);
  for (const int threads : {2, 4}) {
    ExpectSame(expected, RunAll(threads), "threads: " + std::to_string(threads));
  }
}

TEST(Determinism, TwentyRepeats) {
  const std::vector<Result> expected = RunAll(2);
  for (int repeat = 1; repeat < 20; ++repeat) {
    ExpectSame(expected, RunAll(2), "repeat " + std::to_string(repeat));
  }
}

TEST(Determinism, AnyFloatingPointEnvironmentOfTheHost) {
  const std::vector<Result> expected = RunAll(2);
  for (const HostFloatMode mode : kHostFloatModes) {
    const int round_before = std::fegetround();
    {
      const HostFloatEnvironment host(mode);
      const int round_inside = std::fegetround();
      const std::vector<Result> results = RunAll(2);
      EXPECT_EQ(std::fegetround(), round_inside) << "the host's choice is gone";
      ExpectSame(expected, results, "mode " + std::to_string(static_cast<int>(mode)));
    }
    EXPECT_EQ(std::fegetround(), round_before);
  }
}

// A window, its residuals, and what is known of a pose, on one and the same graph.
TEST(Determinism, WindowResidualsAndCovariance) {
  const SeededGraph seeded = Seeded(1);
  const auto run = [&](int num_threads) {
    const SlamGraph& graph = seeded.graph;
    MapState state = seeded.state;
    SolverOptions options;
    options.num_threads = num_threads;
    WindowOptions window;
    window.num_free_poses = 15;
    EXPECT_TRUE(SolveWindow(options, window, graph, &state).IsSolutionUsable());
    std::vector<Eigen::Matrix3d> covariances;
    const int last = graph.num_poses() - 1;
    const Status status =
        ComputePoseCovariances(options, graph, state, {{last, last}}, &covariances);
    EXPECT_TRUE(status.ok()) << status.message();
    Residuals residuals;
    EXPECT_TRUE(EvaluateResiduals(options, graph, state, &residuals).ok());
    const double* numbers = covariances.front().data();
    Result result{{}, state.poses, state.points, {numbers, numbers + 9}};
    for (const Eigen::Vector3d& step : residuals.odometry) {
      result.figures.insert(result.figures.end(), step.data(), step.data() + 3);
    }
    for (const Eigen::Vector2d& beam : residuals.beams) {
      result.figures.insert(result.figures.end(), beam.data(), beam.data() + 2);
    }
    return result;
  };
  const Result expected = run(1);
  for (const int threads : {2, 4}) ExpectSame(expected, run(threads), std::to_string(threads));
  for (const HostFloatMode mode : kHostFloatModes) {
    const HostFloatEnvironment host(mode);
    ExpectSame(expected, run(2), "mode " + std::to_string(static_cast<int>(mode)));
  }
}

}  // namespace
}  // namespace plumbline
