#include "plumbline/solvers/solve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/terms/terms.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

NoisyRoom DisturbedRoom() {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.03, room.graph, &room.state);
  return room;
}

SolverOptions OptionsFor(SolverType type) {
  SolverOptions options;
  options.type = type;
  options.factors.shape = true;  // every term takes part
  options.rounds.max_coarse_rounds = 2;
  options.rounds.max_fine_rounds = 2;
  return options;
}

/// Fails with a message that holds `culprit` and touches nothing.
void ExpectFailure(const SolverOptions& options, const SlamGraph& graph, MapState* state,
                   const std::string& culprit) {
  const MapState before = *state;
  const SolverSummary summary = RefineState(options, graph, state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_FALSE(summary.IsSolutionUsable());
  EXPECT_THAT(summary.message, HasSubstr(culprit));
  EXPECT_THAT(summary.FullReport(), HasSubstr(culprit));
  const auto same_bits = [](const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
  };
  EXPECT_TRUE(same_bits(state->poses, before.poses));
  EXPECT_TRUE(same_bits(state->points, before.points));
}

TEST(SolutionTest, IsWhatBecomesOfTheInitialPoses) {
  const SlamGraph graph = DisturbedRoom().graph;
  const SolverOptions options;
  MapState expected = graph.InitialState();
  const SolverSummary summary = RefineState(options, graph, &expected);
  const Solution solution = Solve(graph, options);
  EXPECT_TRUE(solution.status.ok());
  EXPECT_EQ(solution.State(), expected);
  EXPECT_EQ(solution.report.termination, summary.termination);
  EXPECT_EQ(solution.report.final_marginal_energy, summary.final_marginal_energy);
  ASSERT_EQ(solution.poses.size(), static_cast<std::size_t>(graph.num_poses()));
  EXPECT_EQ(solution.poses[3].x, expected.poses[9]);
  const std::size_t last = graph.num_returns() - 1;
  EXPECT_EQ(solution.point(last), Eigen::Vector2d(&expected.points[2 * last]));
}

TEST(SolutionTest, IsWhatBecomesOfAGivenStart) {
  NoisyRoom room = DisturbedRoom();
  const SolverOptions options;
  const Solution solution = Solve(room.graph, options, room.state);
  EXPECT_TRUE(solution.status.ok());
  RefineState(options, room.graph, &room.state);
  EXPECT_EQ(solution.State(), room.state);
  EXPECT_EQ(Solve(room.graph, options, {room.graph.initial_poses(), {}}).State(),
            Solve(room.graph, options).State());
}

TEST(SolutionTest, OfBadInputIsTheStartWithAStatusThatSaysSo) {
  NoisyRoom room = DisturbedRoom();
  room.graph.AddScan(0, 0, {1.0});
  const Solution refused = Solve(room.graph, SolverOptions(), room.state);
  EXPECT_EQ(refused.status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(refused.status.message(), room.graph.status().message());
  EXPECT_EQ(refused.report.termination, TerminationType::kFailure);
  EXPECT_EQ(refused.State(), room.state);

  EXPECT_EQ(room.graph.TakeStatus().code(), StatusCode::kInvalidArgument);
  MapState of_another_size = room.state;
  of_another_size.poses.resize(7);
  const Solution other = Solve(room.graph, SolverOptions(), of_another_size);
  EXPECT_EQ(other.status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(other.poses.size(), 2u);
}

TEST(SolutionTest, OfASolveThatFailedIsTheStartWithAStatusThatSaysSo) {
  const NoisyRoom room = DisturbedRoom();
  SolverOptions options;
  options.callback = [](const IterationSummary&) -> bool { throw std::bad_alloc(); };
  const Solution failed = Solve(room.graph, options, room.state);
  EXPECT_EQ(failed.status.code(), StatusCode::kUnavailable);
  EXPECT_EQ(failed.status.message(), failed.report.message);
  EXPECT_THAT(failed.status.message(), HasSubstr("out of memory"));
  EXPECT_EQ(failed.State(), room.state);
}

std::string NameOf(const testing::TestParamInfo<SolverType>& info) { return ToString(info.param); }

class SolveWith : public testing::TestWithParam<SolverType> {};
INSTANTIATE_TEST_SUITE_P(EverySolver, SolveWith,
                         testing::Values(SolverType::kReduced, SolverType::kAlternatingCg,
                                         SolverType::kCeres),
                         NameOf);

// Those that minimise over poses and points in rounds of associations.
class SolveInRoundsWith : public testing::TestWithParam<SolverType> {};
INSTANTIATE_TEST_SUITE_P(PointSolvers, SolveInRoundsWith,
                         testing::Values(SolverType::kAlternatingCg, SolverType::kCeres), NameOf);

TEST_P(SolveInRoundsWith, BringsThePosesCloserToTheTruth) {
  NoisyRoom room = DisturbedRoom();
  const double before_m = MeanPoseError(room);
  const SolverSummary summary = RefineState(OptionsFor(GetParam()), room.graph, &room.state);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_TRUE(summary.acceptance.IsBetter());
  EXPECT_GT(before_m, 0.02);
  // What is left is common to all poses but the first, which is fixed: the lines, and with them the
  // other poses, follow it by and by.
  EXPECT_LT(MeanPoseError(room), 0.5 * before_m);
  EXPECT_EQ(summary.rounds.size(), 5u);  // the last one with all returns
  EXPECT_EQ(summary.num_poses, 12u);
  EXPECT_EQ(summary.num_points, room.graph.num_returns());
  int iterations = 0;
  double best = std::numeric_limits<double>::infinity();
  for (const RoundSummary& round : summary.rounds) {
    EXPECT_EQ(round.kept, round.marginal_energy < best);
    best = std::min(best, round.marginal_energy);
    EXPECT_LE(round.final_cost, round.initial_cost);
    EXPECT_GT(round.num_lines, 0u);
    EXPECT_GT(round.num_shape_pairs, 0u);
    iterations += round.iterations;
  }
  EXPECT_EQ(summary.final_marginal_energy, best);
  EXPECT_EQ(static_cast<int>(summary.iterations.size()), iterations);
  EXPECT_DOUBLE_EQ(summary.rounds.front().radius_m, 0.3);
  EXPECT_DOUBLE_EQ(summary.rounds.back().radius_m, 0.1);
  const double gate = SolverOptions().factors.manifold.robust_gate_sigmas;
  EXPECT_DOUBLE_EQ(summary.rounds.front().gate_sigmas, 2.0 * gate);
  EXPECT_DOUBLE_EQ(summary.rounds.back().gate_sigmas, gate);
}

TEST_P(SolveInRoundsWith, ANoisyScannerGetsWiderNeighborhoods) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = OptionsFor(GetParam());
  options.factors.beam.sigma_range_m = 0.04;
  options.factors.manifold.sigma_m = 0.03;
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_FALSE(summary.rounds.empty());
  EXPECT_DOUBLE_EQ(summary.rounds.front().radius_m, 0.3);
  EXPECT_DOUBLE_EQ(summary.rounds.back().radius_m, 0.25);  // five times 0.05 m
}

TEST_P(SolveWith, ReturnsAPerfectSeedBitForBit) {
  // Walls that do not meet, seen without noise: at the truth, every line passes exactly through its
  // points and every residual is zero but for rounding.
  SyntheticScene scene;
  scene.faces = {{{2, -1}, {2, 1}}, {{-1, 2}, {1, 2}}, {{-2, -1}, {-2, 1}}, {{-1, -2}, {1, -2}}};
  scene.laser = PanoramicLaser(360);
  scene.poses = {{0, 0, 0.1}, {0.1, 0.1, 0.2}, {0.2, 0, 0.3}, {0.1, -0.1, 0.4}};
  SlamGraph graph = MakeGraph(scene);
  for (int i = 0; i + 1 < graph.num_poses(); ++i) {
    graph.AddOdometry({i, i + 1, Between(scene.poses[i], scene.poses[i + 1])});
  }
  MapState state = graph.InitialState();
  const SolverSummary summary = RefineState(OptionsFor(GetParam()), graph, &state);
  EXPECT_EQ(summary.termination, TerminationType::kNoImprovement) << summary.message;
  EXPECT_TRUE(summary.IsSolutionUsable());
  EXPECT_THAT(summary.message, HasSubstr("the seed is returned as it was"));
  EXPECT_FALSE(summary.acceptance.IsBetter());
  EXPECT_EQ(state, graph.InitialState());
}

TEST_P(SolveInRoundsWith, StopsWithTheBestStateSoFarWhenAskedTo) {
  NoisyRoom room = DisturbedRoom();
  const double before_m = MeanPoseError(room);
  SolverOptions options = OptionsFor(GetParam());
  std::vector<IterationSummary> rows;
  options.callback = [&](const IterationSummary& it) {
    rows.push_back(it);
    return it.round < 2;
  };
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped) << summary.message;
  EXPECT_EQ(summary.rounds.size(), 2u);
  ASSERT_EQ(summary.iterations.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].iteration, static_cast<int>(i) + 1);
    EXPECT_EQ(rows[i].round, i + 1 < rows.size() ? 1 : 2);
  }
  EXPECT_TRUE(summary.acceptance.IsBetter());
  EXPECT_LT(MeanPoseError(room), before_m);
}

TEST_P(SolveInRoundsWith, ToldToStopAtOnceSaysThatItStopped) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = OptionsFor(GetParam());
  ASSERT_TRUE(RefineState(options, room.graph, &room.state).IsSolutionUsable());
  // Lines this wide blur what is sharp already: the round is undone.
  options.rounds.coarse_radius_m = 1.0;
  options.callback = [](const IterationSummary&) { return false; };
  const std::vector<double> poses = room.state.poses;
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped) << summary.message;
  EXPECT_EQ(summary.rounds.size(), 1u);
  EXPECT_FALSE(summary.rounds.front().kept);
  EXPECT_EQ(room.state.poses, poses);
}

TEST_P(SolveWith, TakesPosesThatNothingTiesTogether) {
  SyntheticScene scene;
  // Two islands out of sight of each other, one of them a single wall, and a pose without a scan.
  scene.faces = {{{2, -1}, {2, 1}}, {{-1, 2}, {1, 2}}, {{50, -1}, {50, 1}}};
  scene.laser = PanoramicLaser(360);
  scene.laser.max_range_m = 5.0;
  scene.range_sigma_m = 0.01;
  scene.poses = {{0, 0, 0}, {0.1, 0, 0}, {48, 0, 0}, {48.1, 0.1, 0}};
  SlamGraph graph = MakeGraph(scene);
  const int pose_id = graph.AddPose({-9, -9, 1}, 9.0);
  MapState state = graph.InitialState();
  const SolverSummary summary = RefineState(OptionsFor(GetParam()), graph, &state);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  for (const double value : state.poses) EXPECT_TRUE(std::isfinite(value));
  for (const double value : state.points) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(state.WorldFromRobot(pose_id).x, -9.0);
  // The wall of the second island says nothing of the way along it.
  EXPECT_NEAR(state.WorldFromRobot(2).x, 48.0, 0.05);
  EXPECT_NEAR(state.WorldFromRobot(2).y, 0.0, 0.2);
}

TEST_P(SolveInRoundsWith, FailsOnAStateWithoutAnEnergy) {
  NoisyRoom room = DisturbedRoom();
  const Pose2 laser = room.graph.WorldFromLaser(0, room.state.poses);
  room.state.points[0] = laser.x;
  room.state.points[1] = laser.y;
  ExpectFailure(OptionsFor(GetParam()), room.graph, &room.state, "returned as it was");
}

TEST(SolveTest, AnyNumberOfThreadsGivesTheSameBits) {
  NoisyRoom one = DisturbedRoom();
  SolverOptions options = OptionsFor(SolverType::kAlternatingCg);
  options.num_threads = 1;
  RefineState(options, one.graph, &one.state);
  for (const int num_threads : {2, 3}) {
    NoisyRoom many = DisturbedRoom();
    options.num_threads = num_threads;
    RefineState(options, many.graph, &many.state);
    EXPECT_EQ(many.state, one.state) << num_threads;
  }
}

TEST(SolveTest, SummarisesTheTermsOfTheLastRound) {
  NoisyRoom room = DisturbedRoom();
  const SolverSummary summary =
      RefineState(OptionsFor(SolverType::kAlternatingCg), room.graph, &room.state);
  const auto term = [&](const char* name) { return TermOfSummary(summary, name); };
  EXPECT_EQ(term(kMotionTerm).count, 11u);
  EXPECT_EQ(term(kRelativePoseTerm).count, 2u);
  EXPECT_EQ(term(kRangeBeamTerm).count, room.graph.num_returns());
  EXPECT_EQ(term(kManifoldTerm).count, summary.rounds.back().num_lines);
  EXPECT_EQ(term("shape").count, summary.rounds.back().num_shape_pairs);
  double initial = 0.0, final = 0.0;
  for (const TermSummary& t : summary.terms) {
    initial += t.initial_cost;
    final += t.final_cost;
  }
  EXPECT_NEAR(initial, summary.rounds.back().initial_cost, 1e-9 * initial);
  EXPECT_NEAR(final, summary.rounds.back().final_cost, 1e-9 * initial);
}

TEST(SolveTest, NamesWhatIsWrongWithTheState) {
  for (const double bad : {kNaN, kInfinity}) {
    NoisyRoom room = DisturbedRoom();
    room.state.poses[3 * 5 + 2] = bad;
    ExpectFailure(SolverOptions(), room.graph, &room.state, "pose 5");
    room = DisturbedRoom();
    room.state.points[2 * 123] = bad;
    ExpectFailure(SolverOptions(), room.graph, &room.state, "point 123");
  }
}

TEST(SolveTest, FailsOnAGraphWithoutReturns) {
  SlamGraph graph;
  MapState state;
  ExpectFailure(SolverOptions(), graph, &state, "no laser returns");
  graph.AddPose({1, 2, 3}, 0.0);
  graph.ExtendState(&state);
  ExpectFailure(SolverOptions(), graph, &state, "no laser returns");
}

TEST(SolveTest, AStateOfAnotherSizeThanTheGraphIsRefused) {
  NoisyRoom room = DisturbedRoom();
  const std::string points = std::to_string(2 * room.graph.num_returns());
  const std::string of_graph = "which takes 36 and " + points + " coordinates, ";
  MapState state;
  ExpectFailure(SolverOptions(), room.graph, &state, of_graph + "but the state has 0 and 0");
  state = room.state;
  state.poses.pop_back();
  ExpectFailure(SolverOptions(), room.graph, &state,
                of_graph + "but the state has 35 and " + points);
  state = room.state;
  state.points.resize(200);
  ExpectFailure(SolverOptions(), room.graph, &state, of_graph + "but the state has 36 and 200");
}

TEST(SolveTest, NamesTheOptionThatIsWrong) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options;
  options.factors.beam.sigma_range_m = 0.0;
  ExpectFailure(options, room.graph, &room.state, "factors.beam.sigma_range_m");
  options = SolverOptions();
  options.rounds.fine_radius_m = kNaN;
  ExpectFailure(options, room.graph, &room.state, "rounds.fine_radius_m");
  options = SolverOptions();
  options.num_threads = 0;
  ExpectFailure(options, room.graph, &room.state, "num_threads");
}

TEST(SolveTest, PassesOnWhatCeresSaysOfItsOptions) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = OptionsFor(SolverType::kCeres);
  options.ceres->trust_region_strategy_type = ceres::DOGLEG;
  options.ceres->linear_solver_type = ceres::CGNR;
  ExpectFailure(options, room.graph, &room.state, "DOGLEG");
}

TEST(SolveTest, CeresTakesTheRoundsOfTheReducedSolver) {
  NoisyRoom own = DisturbedRoom();
  const SolverSummary expected =
      RefineState(OptionsFor(SolverType::kReduced), own.graph, &own.state);
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = OptionsFor(SolverType::kCeres);
  options.ceres->reduced = true;
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_EQ(summary.solver, "ceres, reduced");
  EXPECT_EQ(summary.termination, TerminationType::kConverged) << summary.message;
  EXPECT_TRUE(summary.rounds.empty());
  EXPECT_GT(summary.landmark_rounds.size(), 1u);
  EXPECT_EQ(summary.iterations.front().phase, "joint");
  EXPECT_NEAR(summary.final_marginal_energy, expected.final_marginal_energy,
              0.01 * expected.final_marginal_energy);
  EXPECT_NE(room.state.points, DisturbedRoom().state.points);
}

TEST(SolveTest, ASurfaceThatTheCallerHasMeasuredGivesTheSameResult) {
  const SolverOptions options;
  NoisyRoom expected = DisturbedRoom();
  RefineState(options, expected.graph, &expected.state);
  NoisyRoom room = DisturbedRoom();
  ThreadPool pool(1);
  const MeasuredSurface surface =
      MeasureSurface(room.graph, NormalOptionsFor(options.factors.beam), &pool);
  EXPECT_TRUE(RefineState(options, surface, room.graph, &room.state).IsSolutionUsable());
  EXPECT_EQ(room.state, expected.state);
}

TEST_P(SolveWith, PointsThatAreNotGivenAreWhereTheMeasurementsPutThem) {
  NoisyRoom room = MakeNoisyRoom();
  DisturbPoses(0.03, room.graph, &room.state);
  MapState given{room.state.poses, room.graph.MeasuredMap(room.state.poses)};
  MapState without{room.state.poses, {}};
  SolverOptions options = OptionsFor(GetParam());
  options.num_threads = 1;
  const SolverSummary with_points = RefineState(options, room.graph, &given);
  const SolverSummary summary = RefineState(options, room.graph, &without);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  // The order in which Ceres eliminates depends on the addresses of the unknowns.
  const bool is_exact = GetParam() != SolverType::kCeres;
  ASSERT_EQ(without.poses.size(), given.poses.size());
  ASSERT_EQ(without.points.size(), given.points.size());
  const double tolerance_m = is_exact ? 0.0 : 1e-9;
  for (std::size_t i = 0; i < given.poses.size(); ++i) {
    EXPECT_NEAR(without.poses[i], given.poses[i], tolerance_m);
  }
  for (std::size_t i = 0; i < given.points.size(); ++i) {
    EXPECT_NEAR(without.points[i], given.points[i], tolerance_m);
  }
  ASSERT_EQ(summary.terms.size(), with_points.terms.size());
  for (std::size_t i = 0; i < summary.terms.size(); ++i) {
    const double cost = with_points.terms[i].initial_cost;
    // Nothing but the rounding of measured points.
    EXPECT_NEAR(summary.terms[i].initial_cost, cost, 1e-20 + (is_exact ? 0.0 : 1e-9 * cost));
  }
}

TEST(SolveTest, AFailureLeavesAStateWithoutPointsAsItWas) {
  const NoisyRoom room = MakeNoisyRoom();
  SolverOptions options;
  options.callback = [](const IterationSummary&) -> bool { throw std::runtime_error("no"); };
  MapState state{room.state.poses, {}};
  EXPECT_FALSE(RefineState(options, room.graph, &state).IsSolutionUsable());
  EXPECT_EQ(state, (MapState{room.state.poses, {}}));
}

TEST(SolveTest, ASurfaceOfAnotherGraphIsRefused) {
  NoisyRoom room = DisturbedRoom();
  const MapState before = room.state;
  const SolverSummary summary =
      RefineState(SolverOptions(), MeasuredSurface(), room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_THAT(summary.message, testing::HasSubstr("but the surface 0 normals"));
  EXPECT_EQ(room.state, before);
}

class SolveFalseEdges : public testing::TestWithParam<SolverType> {};
INSTANTIATE_TEST_SUITE_P(JointSolvers, SolveFalseEdges,
                         testing::Values(SolverType::kReduced, SolverType::kAlternatingCg,
                                         SolverType::kCeres),
                         [](const testing::TestParamInfo<SolverType>& info) {
                           return std::string(ToString(info.param));
                         });

// An edge that is off by 0.4 m, and surer than all returns.
TEST_P(SolveFalseEdges, AreIgnoredAndNamed) {
  SolverOptions options = OptionsFor(GetParam());
  double error_m[2] = {};
  for (const bool tested : {false, true}) {
    NoisyRoom room = RoomWithEdges();
    DisturbPoses(0.02, room.graph, &room.state);
    const std::size_t edge = room.graph.relative_poses().size();
    const Pose2 motion = Between(room.truth[3], room.truth[8]) * Pose2(0.0, 0.4, 0.0);
    room.graph.AddRelativePose({3, 8, motion, 1e-7 * Eigen::Matrix3d::Identity()});
    options.test_edges = tested;
    const SolverSummary summary = RefineState(options, room.graph, &room.state);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    error_m[tested] = MeanPoseError(room);
    ASSERT_EQ(summary.ignored_edges.size(), tested ? 1u : 0u);
    if (!tested) continue;
    EXPECT_EQ(summary.ignored_edges[0].edge, edge);
    EXPECT_NEAR(summary.ignored_edges[0].off_m, 0.4, 0.03);
    EXPECT_THAT(summary.FullReport(), testing::HasSubstr("    3 to 8 is 0.4"));
    // It still counts for whoever asks.
    Residuals residuals;
    ASSERT_TRUE(EvaluateResiduals(options, room.graph, room.state, &residuals).ok());
    EXPECT_GT(residuals.relative_poses[edge].norm(), 100.0);
  }
  EXPECT_LT(error_m[true], 0.005);
  EXPECT_GT(error_m[false], 0.02);
}

TEST(SolveTest, NormalsSpanSixTimesTheRangeNoise) {
  RangeBeamOptions beam;
  beam.sigma_range_m = 0.001;
  EXPECT_DOUBLE_EQ(NormalOptionsFor(beam).half_window_m, 0.06);
  beam.sigma_range_m = 0.05;
  EXPECT_DOUBLE_EQ(NormalOptionsFor(beam).half_window_m, 0.3);
}

}  // namespace
}  // namespace plumbline
