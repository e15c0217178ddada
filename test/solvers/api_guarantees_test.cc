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

#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/covariance.h"
#include "plumbline/solvers/incremental_solver.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/landmarks/landmark_energy.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/seed.h"
#include "plumbline/solvers/sliding_window.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// With enough edges for the solvers that look at nothing else.
NoisyRoom DisturbedRoom() {
  NoisyRoom room = MakeNoisyRoom();
  for (const OdometryConstraint& step : room.graph.odometry()) {
    room.graph.AddRelativePose(
        {step.from, step.to, step.from_from_to, 1e-4 * Eigen::Matrix3d::Identity()});
  }
  DisturbPoses(0.03, room.graph, &room.state);
  return room;
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
  options.ceres->reduced = way.ceres_reduced;
  // Two threads of Ceres add up in any order.
  options.num_threads = way.type == SolverType::kCeres ? 1 : 2;
  options.rounds.max_coarse_rounds = 1;
  options.rounds.max_fine_rounds = 2;
  return options;
}

// What a solve makes of a graph and its state.
struct Outcome {
  SolverSummary summary;
  MapState state;
  MeasurementCorrections corrections;
};

Outcome SolveThe(const Way& way, const SolverOptions& options, const SlamGraph& graph,
                 const MapState& start) {
  Outcome outcome;
  outcome.state = start;
  if (way.window) {
    WindowOptions window;
    window.num_free_poses = 6;
    outcome.summary = SolveWindow(options, window, graph, &outcome.state);
  } else if (way.calibration) {
    CalibrationOptions on;
    on.laser_mounting = on.range_bias = true;
    Calibration calibration;
    outcome.summary = SolveWithCalibration(options, on, graph, &outcome.state, &calibration);
    outcome.corrections = calibration.corrections;
  } else {
    outcome.summary = RefineState(options, graph, &outcome.state);
  }
  return outcome;
}

void ExpectSame(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.corrections.range_m, b.corrections.range_m);
  EXPECT_EQ(PoseArray(a.corrections.robot_from_laser), PoseArray(b.corrections.robot_from_laser));
  EXPECT_EQ(PoseArray(a.corrections.odometry), PoseArray(b.corrections.odometry));
}

// Of poses with the measurements of `graph`, in the terms of the given room and the surfaces as
// that places them.
double EnergyOf(const Way& way, const NoisyRoom& given, const SlamGraph& graph,
                const std::vector<double>& poses) {
  if (OptionsFor(way).MovesPosesOnly())
    return GraphChi2(given.graph.relative_poses(), PosesOf(poses));
  const FactorOptions factors;
  ThreadPool pool(1);
  const LineLandmarks cut =
      CutIntoLandmarks(given.graph, given.state.poses,
                       MeasureSurface(given.graph, NormalOptionsFor(factors.beam), &pool),
                       LandmarkOptionsFor(factors, AssociationOptions()), &pool);
  return LandmarkEnergies(graph, factors, cut, {}, {&poses}, &pool)[0];
}

class EveryWay : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(
    ApiGuarantees, EveryWay,
    testing::Values(Way{"Reduced"}, Way{"AlternatingCg", SolverType::kAlternatingCg},
                    Way{"Published", SolverType::kPublished}, Way{"Ceres", SolverType::kCeres},
                    Way{"CeresReduced", SolverType::kCeres, true},
                    Way{"PoseGraph", SolverType::kPoseGraph}, Way{"Sgd", SolverType::kSgd},
                    Way{"Window", SolverType::kReduced, false, true},
                    Way{"Calibration", SolverType::kReduced, false, false, true}),
    [](const auto& info) { return info.param.name; });

TEST_P(EveryWay, StopsWithinAnIterationAndIsNoWorse) {
  const NoisyRoom given = DisturbedRoom();
  for (const int stop_at : {1, 2}) {
    SolverOptions options = OptionsFor(GetParam());
    int num_calls = 0;
    options.callback = [&](const IterationSummary&) { return ++num_calls != stop_at; };
    const Outcome outcome = SolveThe(GetParam(), options, given.graph, given.state);
    const SolverSummary& summary = outcome.summary;
    EXPECT_EQ(summary.termination, TerminationType::kUserStopped) << summary.message;
    EXPECT_EQ(num_calls, stop_at) << "asked again after it said stop";
    EXPECT_LE(summary.iterations.size(), stop_at + 0u);
    EXPECT_LE(EnergyOf(GetParam(), given, given.graph.Corrected(outcome.corrections),
                       outcome.state.poses),
              EnergyOf(GetParam(), given, given.graph, given.state.poses));
  }
}

TEST_P(EveryWay, ACallbackThatThrowsIsAFailureThatChangesNothing) {
  const NoisyRoom given = DisturbedRoom();
  const auto expect_failure = [&](const ProgressCallback& callback, const std::string& message) {
    SolverOptions options = OptionsFor(GetParam());
    options.callback = callback;
    const Outcome outcome = SolveThe(GetParam(), options, given.graph, given.state);
    EXPECT_EQ(outcome.summary.termination, TerminationType::kFailure);
    EXPECT_THAT(outcome.summary.message, HasSubstr(message));
    ExpectSame(outcome, {{}, given.state, {}});
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

TEST_P(EveryWay, RefusesAGraphThatRefusedAMeasurement) {
  NoisyRoom given = DisturbedRoom();
  given.graph.AddRelativePose({0, 1000, Pose2()});
  const std::string message = given.graph.status().message();
  EXPECT_THAT(message, HasSubstr("(0 -> 1000): no pose with id 1000"));
  const Outcome outcome = SolveThe(GetParam(), OptionsFor(GetParam()), given.graph, given.state);
  EXPECT_EQ(outcome.summary.termination, TerminationType::kFailure);
  EXPECT_EQ(outcome.summary.message, message);
  ExpectSame(outcome, {{}, given.state, {}});
}

TEST_P(EveryWay, TwoThreadsMaySolveOneGraph) {
  const NoisyRoom a = DisturbedRoom();
  MapState b = a.state;
  DisturbPoses(0.02, a.graph, &b);
  ASSERT_NE(a.state.poses, b.poses);
  const SolverOptions options = OptionsFor(GetParam());
  const auto solve = [&](const MapState& start) {
    return SolveThe(GetParam(), options, a.graph, start);
  };
  const Outcome a_alone = solve(a.state), b_alone = solve(b);
  Outcome b_at_once;
  std::thread other([&] { b_at_once = solve(b); });
  const Outcome a_at_once = solve(a.state);
  other.join();
  ExpectSame(a_at_once, a_alone);
  ExpectSame(b_at_once, b_alone);
}

// The last phase of a calibration is a Solve, whose iterations the callback sees as well.
TEST(ApiGuarantees, ACalibrationStoppedInItsSolveKeepsWhatItFound) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options;
  CalibrationOptions on;
  on.range_bias = true;
  options.callback = [](const IterationSummary& row) { return row.phase == "sensors"; };
  Calibration calibration;
  const SolverSummary summary =
      SolveWithCalibration(options, on, room.graph, &room.state, &calibration);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped) << summary.message;
  EXPECT_EQ(calibration.parameters.size(), 1u);
  EXPECT_GT(calibration.steps, 0);
  EXPECT_EQ(calibration.corrections.range_m.size(), room.graph.num_returns());
}

TEST(ApiGuarantees, WhatIsNoSolveRefusesAGraphThatRefusedAMeasurement) {
  NoisyRoom room = DisturbedRoom();
  room.graph.AddScan(0, 0, {1.0});
  const MapState given = room.state;
  const auto expect_refused = [&](const Status& status) {
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(status.message(), room.graph.status().message());
    EXPECT_EQ(room.state, given);
  };
  const SolverOptions options;
  SeedingReport report;
  expect_refused(SeedGraph({}, options, room.graph, &room.state, &report));
  LogMapping mapping;
  expect_refused(MapLog(MapLogOptions(), room.graph, nullptr, &mapping));
  EXPECT_EQ(mapping.graph.num_poses(), 0);
  IncrementalSolver incremental;
  expect_refused(incremental.Update(room.graph, UpdateScope::kAll, &room.state.poses));
  std::vector<Eigen::Matrix3d> covariances;
  expect_refused(ComputePoseCovariances(options, room.graph, room.state, {{0, 0}}, &covariances));
  Residuals residuals;
  expect_refused(EvaluateResiduals(options, room.graph, room.state, &residuals));
}

TEST(ApiGuarantees, ASeedingWhoseProgressThrowsChangesNothing) {
  NoisyRoom room = DisturbedRoom();
  const MapState given = room.state;
  ThreadPool pool(2);
  SeedingReport report;
  const Status status = SeedGraph(
      SeedingOptions(), MotionOptions(), SurfaceOf(room.graph),
      [](SeedingPhase, int, int) -> bool { throw std::runtime_error("no more paper"); }, &pool,
      room.graph, &room.state, &report);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("no more paper"));
  EXPECT_EQ(room.state, given);
}

TEST(ApiGuarantees, TwoThreadsMaySeedOneGraph) {
  const SlamGraph graph = MakeNoisyRoom().graph;
  const SolverOptions options;
  MapState a, b;
  SeedingReport report_a, report_b;
  std::thread other([&] { EXPECT_TRUE(SeedGraph({}, options, graph, &b, &report_b).ok()); });
  EXPECT_TRUE(SeedGraph({}, options, graph, &a, &report_a).ok());
  other.join();
  EXPECT_EQ(a, b);
  EXPECT_EQ(PoseArray(report_a.corrections.odometry), PoseArray(report_b.corrections.odometry));
  EXPECT_NE(a.poses, graph.initial_poses());
}

TEST(ApiGuarantees, SeedingForAHostMeasuresTheSurfacesItself) {
  const SlamGraph graph = MakeNoisyRoom().graph;
  MapState a, b;
  SolverOptions options;
  options.factors.motion.translation_floor_m = 0.02;
  ThreadPool pool(1);
  SeedingReport report_a, report_b;
  ASSERT_TRUE(SeedGraph({}, options, graph, &a, &report_a).ok());
  ASSERT_TRUE(SeedGraph({}, options.factors.motion,
                        MeasureSurface(graph, NormalOptionsFor(options.factors.beam), &pool),
                        nullptr, &pool, graph, &b, &report_b)
                  .ok());
  EXPECT_EQ(a, b);
  EXPECT_EQ(PoseArray(report_a.corrections.odometry), PoseArray(report_b.corrections.odometry));
  options.factors.beam.sigma_range_m = -1.0;
  EXPECT_THAT(SeedGraph({}, options, graph, &a, &report_a).message(),
              HasSubstr("beam.sigma_range_m"));
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace plumbline
