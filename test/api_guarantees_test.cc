// What holds for every function that a host calls: it stops when asked to, throws nothing, and does
// not mind what other threads do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <new>
#include <ostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/core/graph_poses.h"
#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/reduced/patch_energy.h"
#include "plumbline/solvers/reduced/surface_patches.h"
#include "plumbline/solvers/seeding/seed.h"
#include "plumbline/solvers/sliding_window.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/test/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// With enough edges for the solvers that look at nothing else.
SlamGraph DisturbedGraph() {
  SlamGraph graph = MakeNoisyRoom().graph;
  const std::vector<OdometryConstraint> steps = graph.odometry();
  for (const OdometryConstraint& step : steps) {
    EXPECT_TRUE(graph
                    .AddRelativePose(
                        {step.from, step.to, step.from_from_to, 1e-4 * Eigen::Matrix3d::Identity()})
                    .ok());
  }
  DisturbPoses(0.03, &graph);
  return graph;
}

// Every way of solving a graph.
struct Way {
  std::string name;
  SolverType type = SolverType::kReduced;
  bool ceres_reduced = false;
  bool window = false;
  bool calibration = false;
};
std::ostream& operator<<(std::ostream& out, const Way& way) { return out << way.name; }

SolverOptions OptionsFor(const Way& way) {
  SolverOptions options;
  options.type = way.type;
  options.ceres.reduced = way.ceres_reduced;
  // Two threads of Ceres add up in any order.
  options.num_threads = way.type == SolverType::kCeres ? 1 : 2;
  options.rounds.max_coarse_rounds = 1;
  options.rounds.max_fine_rounds = 2;
  return options;
}

SolverSummary SolveThe(const Way& way, const SolverOptions& options, SlamGraph* graph) {
  if (way.window) {
    WindowOptions window;
    window.num_free_poses = 6;
    return SolveWindow(options, window, graph);
  }
  if (way.calibration) {
    CalibrationOptions on;
    on.laser_mounting = on.range_bias = true;
    Calibration calibration;
    return SolveWithCalibration(options, on, graph, &calibration);
  }
  return Solve(options, graph);
}

void ExpectSameSensors(const SlamGraph& a, const SlamGraph& b) {
  EXPECT_EQ(a.returns().range_m, b.returns().range_m);
  EXPECT_TRUE(a.laser(0) == b.laser(0));
  for (std::size_t i = 0; i < a.odometry().size(); ++i) {
    EXPECT_EQ(a.odometry()[i].from_from_to.x, b.odometry()[i].from_from_to.x);
  }
}

void ExpectSameGraph(const SlamGraph& a, const SlamGraph& b) {
  EXPECT_EQ(a.poses(), b.poses());
  EXPECT_EQ(a.points(), b.points());
  ExpectSameSensors(a, b);
}

// Of the state of `graph`, in the terms of the given one and the surfaces as that places them.
double EnergyOf(const Way& way, const SlamGraph& given, const SlamGraph& graph) {
  const std::vector<Pose2> poses = PosesOf(graph);
  if (MovesPosesOnly(way.type)) return GraphChi2(given.relative_poses(), poses);
  const FactorOptions factors;
  ThreadPool pool(1);
  const MeasuredSurface surface = MeasureSurface(graph, NormalOptionsFor(factors.beam), &pool);
  const SurfacePatches cut =
      CutIntoPatches(given, MeasureSurface(given, NormalOptionsFor(factors.beam), &pool),
                     PatchOptionsFor(factors, AssociationOptions()), &pool);
  return PatchEnergies(graph, surface, factors, cut, {&graph.poses()}, &pool)[0];
}

class EveryWay : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(
    ApiGuarantees, EveryWay,
    testing::Values(Way{"Reduced"}, Way{"AlternatingCg", SolverType::kAlternatingCg},
                    Way{"Ceres", SolverType::kCeres}, Way{"CeresReduced", SolverType::kCeres, true},
                    Way{"PoseGraph", SolverType::kPoseGraph}, Way{"Sgd", SolverType::kSgd},
                    Way{"Window", SolverType::kReduced, false, true},
                    Way{"Calibration", SolverType::kReduced, false, false, true}),
    [](const auto& info) { return info.param.name; });

TEST_P(EveryWay, StopsWithinAnIterationAndIsNoWorse) {
  const SlamGraph given = DisturbedGraph();
  for (const int stop_at : {1, 2}) {
    SlamGraph graph = given;
    SolverOptions options = OptionsFor(GetParam());
    int num_calls = 0;
    options.callback = [&](const IterationSummary&) { return ++num_calls != stop_at; };
    const SolverSummary summary = SolveThe(GetParam(), options, &graph);
    EXPECT_EQ(summary.termination, TerminationType::kUserStopped) << summary.message;
    EXPECT_EQ(num_calls, stop_at) << "asked again after it said stop";
    EXPECT_LE(summary.iterations.size(), stop_at + 0u);
    EXPECT_LE(EnergyOf(GetParam(), given, graph), EnergyOf(GetParam(), given, given));
  }
}

TEST_P(EveryWay, ACallbackThatThrowsIsAFailureThatChangesNothing) {
  const SlamGraph given = DisturbedGraph();
  const auto expect_failure = [&](const ProgressCallback& callback, const std::string& message) {
    SlamGraph graph = given;
    SolverOptions options = OptionsFor(GetParam());
    options.callback = callback;
    const SolverSummary summary = SolveThe(GetParam(), options, &graph);
    EXPECT_EQ(summary.termination, TerminationType::kFailure);
    EXPECT_THAT(summary.message, HasSubstr(message));
    ExpectSameGraph(graph, given);
  };
  int num_calls = 0;
  expect_failure(
      [&](const IterationSummary&) -> bool {
        if (++num_calls < 2) return true;
        throw std::runtime_error("no more paper");
      },
      "no more paper");
  expect_failure([](const IterationSummary&) -> bool { throw std::bad_alloc(); }, "out of memory");
  expect_failure([](const IterationSummary&) -> bool { throw 7; }, "no std::exception");
}

TEST_P(EveryWay, TwoThreadsMaySolveAGraphEach) {
  SlamGraph a = DisturbedGraph(), b = a;
  DisturbPoses(0.02, &b);
  ASSERT_NE(a.poses(), b.poses());
  SlamGraph a_alone = a, b_alone = b;
  SolveThe(GetParam(), OptionsFor(GetParam()), &a_alone);
  SolveThe(GetParam(), OptionsFor(GetParam()), &b_alone);
  std::thread other([&] { SolveThe(GetParam(), OptionsFor(GetParam()), &b); });
  SolveThe(GetParam(), OptionsFor(GetParam()), &a);
  other.join();
  ExpectSameGraph(a, a_alone);
  ExpectSameGraph(b, b_alone);
}

// The last phase of a calibration is a Solve, whose iterations the callback sees as well.
TEST(ApiGuarantees, ACalibrationStoppedInItsSolveKeepsWhatItFound) {
  const SlamGraph given = DisturbedGraph();
  SlamGraph graph = given;
  SolverOptions options;
  CalibrationOptions on;
  on.range_bias = true;
  options.callback = [](const IterationSummary& row) { return row.phase == "sensors"; };
  Calibration calibration;
  const SolverSummary summary = SolveWithCalibration(options, on, &graph, &calibration);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped) << summary.message;
  EXPECT_EQ(calibration.parameters.size(), 1u);
  EXPECT_GT(calibration.steps, 0);
}

TEST(ApiGuarantees, ASeedingWhoseProgressThrowsChangesNothing) {
  const SlamGraph given = DisturbedGraph();
  SlamGraph graph = given;
  ThreadPool pool(2);
  SeedingReport report;
  const Status status = SeedGraph(
      SeedingOptions(), MotionOptions(), NormalsOf(graph),
      [](SeedingPhase, int, int) -> bool { throw std::runtime_error("no more paper"); }, &pool,
      &graph, &report);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("no more paper"));
  ExpectSameGraph(graph, given);
}

TEST(ApiGuarantees, TwoThreadsMaySeedAGraphEach) {
  SlamGraph a = MakeNoisyRoom().graph, b = a;
  const SolverOptions options;
  SeedingReport report_a, report_b;
  std::thread other([&] { EXPECT_TRUE(SeedGraph({}, options, &b, &report_b).ok()); });
  EXPECT_TRUE(SeedGraph({}, options, &a, &report_a).ok());
  other.join();
  ExpectSameGraph(a, b);
  EXPECT_NE(a.poses(), MakeNoisyRoom().graph.poses());
}

TEST(ApiGuarantees, SeedingForAHostMeasuresTheSurfacesItself) {
  SlamGraph a = MakeNoisyRoom().graph, b = a;
  SolverOptions options;
  options.factors.motion.translation_floor_m = 0.02;
  ThreadPool pool(1);
  SeedingReport report;
  ASSERT_TRUE(SeedGraph({}, options, &a, &report).ok());
  ASSERT_TRUE(SeedGraph({}, options.factors.motion,
                        EstimateReturnNormals(b, NormalOptionsFor(options.factors.beam), &pool),
                        nullptr, &pool, &b, &report)
                  .ok());
  ExpectSameGraph(a, b);
  options.factors.beam.sigma_range_m = -1.0;
  EXPECT_THAT(SeedGraph({}, options, &a, &report).message(), HasSubstr("beam.sigma_range_m"));
  ExpectSameGraph(a, b);
}

}  // namespace
}  // namespace plumbline
