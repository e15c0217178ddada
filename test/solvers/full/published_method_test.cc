#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/solvers/association/held_out_returns.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/front_end/global_icp.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

SolverOptions Published() {
  SolverOptions options;
  options.type = SolverType::kPublished;
  options.published.max_passes = 12;
  options.factors.beam.sigma_range_m = 0.03;
  return options;
}

// Scans as dense and as noisy as in the paper's experiment.
NoisyRoom DenseRoom(double range_sigma_m = 0.03) {
  NoisyRoomOptions options;
  options.num_beams = 720;
  options.range_sigma_m = range_sigma_m;
  return MakeNoisyRoom(options);
}

NoisyRoom DisturbedRoom(double sigma = 0.005) {
  NoisyRoom room = DenseRoom();
  DisturbPoses(sigma, room.graph, &room.state);
  return room;
}

std::size_t NumHeldOut(const SlamGraph& graph) {
  std::size_t count = 0;
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    count += HeldOutReturns::CountOf(graph, scan);
  }
  return count;
}

// Mean distance [m] of the map's points from where the beams really ended.
double MapErrorM(const SlamGraph& graph, const std::vector<double>& points) {
  const NoisyRoom exact = DenseRoom(0.0);
  EXPECT_EQ(exact.graph.num_returns(), graph.num_returns());
  double sum = 0.0;
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    sum += std::hypot(points[2 * r] - exact.state.points[2 * r],
                      points[2 * r + 1] - exact.state.points[2 * r + 1]);
  }
  return sum / static_cast<double>(graph.num_returns());
}

double WorstPoseErrorM(const NoisyRoom& room) {
  double worst = 0.0;
  for (std::size_t i = 0; i < room.truth.size(); ++i) {
    const Pose2 pose = room.state.WorldFromRobot(static_cast<int>(i));
    worst = std::max(worst, (pose.translation() - room.truth[i].translation()).norm());
  }
  return worst;
}

TEST(PublishedMethodTest, BringsTheMapNearerToTheTruthFromOneIcpOverAllScans) {
  NoisyRoom room = DisturbedRoom(0.1);
  const SolverOptions options = Published();
  ThreadPool pool(1);
  const MeasuredSurface surface =
      MeasureSurface(room.graph, NormalOptionsFor(options.factors.beam), &pool);
  ASSERT_TRUE(AlignScansGlobally(GlobalIcpOptionsFor(options.factors.beam, IcpMetric::kPointToLine),
                                 options.factors.motion, surface, &pool, room.graph, &room.state)
                  .ok());
  EXPECT_LT(WorstPoseErrorM(room), 0.02);
  const double before_m = MapErrorM(room.graph, room.state.points);
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_LT(MapErrorM(room.graph, room.state.points), 0.8 * before_m);
  EXPECT_LT(WorstPoseErrorM(room), 0.02);
}

TEST(PublishedMethodTest, ReturnsTheStartWhereThePriorsDoHarm) {
  // Beams two degrees apart: the nearest points of a point are across a corner.
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.02, room.graph, &room.state);
  const MapState start = room.state;
  SolverOptions options = Published();
  options.factors.beam.sigma_range_m = 0.01;
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kNoImprovement);
  EXPECT_GE(summary.rounds.size(), 5u);
  EXPECT_TRUE(room.state == start);
  for (const RoundSummary& pass : summary.rounds) EXPECT_FALSE(pass.kept);
}

TEST(PublishedMethodTest, HeldOutPointsAreDrawnToTheLinesOfTheOthers) {
  NoisyRoom room = DisturbedRoom();
  const NoisyRoom exact = DenseRoom(0.0);
  ASSERT_NE(RefineState(Published(), room.graph, &room.state).termination,
            TerminationType::kNoImprovement);
  const std::vector<double> raw = room.graph.MeasuredMap(room.state.poses);
  double raw_sum = 0.0, sum = 0.0;
  for (int scan = 0; scan < room.graph.num_scans(); ++scan) {
    HeldOutReturns::ForEachOf(room.graph, scan, [&](std::size_t r) {
      const auto error = [&](const std::vector<double>& points) {
        return std::hypot(points[2 * r] - exact.state.points[2 * r],
                          points[2 * r + 1] - exact.state.points[2 * r + 1]);
      };
      raw_sum += error(raw);
      sum += error(room.state.points);
    });
  }
  EXPECT_LT(sum, 0.85 * raw_sum);
}

TEST(PublishedMethodTest, TakesTheThicknessOfSurfacesFromTheStart) {
  double sigma_m[2];
  for (const bool from_start : {false, true}) {
    NoisyRoom room = DisturbedRoom();
    SolverOptions options = Published();
    options.published.sigma_from_start = from_start;
    options.published.max_passes = 1;
    const SolverSummary summary = RefineState(options, room.graph, &room.state);
    ASSERT_EQ(summary.terms[3].name, "manifold");
    sigma_m[from_start] = summary.terms[3].sigma;
  }
  EXPECT_EQ(sigma_m[0], SolverOptions().factors.manifold.sigma_m);
  // Less than the 30 mm of the ranges: beams are slanted, and lines follow their points.
  EXPECT_GT(sigma_m[1], 0.01);
  EXPECT_LT(sigma_m[1], 0.035);
}

TEST(PublishedMethodTest, MovesMapAndPosesInTurnAlongConjugateDirections) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = Published();
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  ASSERT_GE(summary.rounds.size(), 6u);
  ASSERT_EQ(summary.iterations.size(), 2 * summary.rounds.size());
  int num_conjugate = 0;
  for (std::size_t i = 0; i < summary.iterations.size(); ++i) {
    const IterationSummary& iteration = summary.iterations[i];
    EXPECT_EQ(iteration.phase, i % 2 == 0 ? "map" : "poses") << i;
    EXPECT_GE(iteration.cost_change, 0.0) << i;
    num_conjugate += iteration.beta > 0.0;
  }
  // All but the first of each kind, and where a direction was no descent.
  EXPECT_GT(num_conjugate, static_cast<int>(1.5 * summary.rounds.size()));
  EXPECT_EQ(summary.iterations[0].beta, 0.0);
  EXPECT_EQ(summary.iterations[1].beta, 0.0);
}

TEST(PublishedMethodTest, EveryPointThatIsNotHeldOutHasATangentLineAndSegmentsHavePairs) {
  NoisyRoom room = DisturbedRoom();
  const SolverSummary summary = RefineState(Published(), room.graph, &room.state);
  ASSERT_FALSE(summary.rounds.empty());
  for (const RoundSummary& pass : summary.rounds) {
    EXPECT_EQ(pass.num_lines, room.graph.num_returns() - NumHeldOut(room.graph));
    EXPECT_GT(pass.num_shape_pairs, 20u);
    EXPECT_LE(pass.final_cost, pass.initial_cost);
  }
  ASSERT_EQ(summary.terms.size(), 5u);
  EXPECT_EQ(summary.terms[3].name, "manifold");
  EXPECT_EQ(summary.terms[3].count, room.graph.num_returns() - NumHeldOut(room.graph));
  EXPECT_EQ(summary.terms[4].name, "shape");
  EXPECT_GT(summary.terms[4].final_cost, 0.0);
}

TEST(PublishedMethodTest, ReportsTheAcceptanceTestAndDoesNotApplyIt) {
  // From the truth, with noise as it is, every step away is a step for the worse.
  NoisyRoom room = DenseRoom();
  const MapState seed = room.state;
  const SolverSummary summary = RefineState(Published(), room.graph, &room.state);
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
  options.published.max_passes = 1000;
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kConverged) << summary.message;
  EXPECT_LT(summary.rounds.size(), 1000u);
}

TEST(PublishedMethodTest, StopsWhenTheCallbackSaysSo) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = Published();
  int calls = 0;
  options.callback = [&](const IterationSummary&) { return ++calls < 5; };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped);
  EXPECT_EQ(calls, 5);
}

}  // namespace
}  // namespace plumbline
