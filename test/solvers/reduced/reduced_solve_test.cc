// Solve with the reduced solver on graphs that are out of the ordinary.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumbline/apps/simulation/world.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/landmarks/landmark_energy.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/sliding_window.h"
#include "plumbline/solvers/terms/terms.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

SolverOptions Reduced(int num_threads = 2) {
  SolverOptions options;
  options.type = SolverType::kReduced;
  options.num_threads = num_threads;
  return options;
}

/// Solves; what holds on any graph: a usable end, finite numbers, no higher energy, and the
/// seed bit for bit if nothing was better.
SolverSummary SolveSoundly(const SolverOptions& options, const SlamGraph& graph, MapState* state) {
  const MapState seed = *state;
  const SolverSummary summary = RefineState(options, graph, state);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  for (const std::vector<double>* values : {&state->poses, &state->points}) {
    EXPECT_TRUE(
        std::all_of(values->begin(), values->end(), [](double v) { return std::isfinite(v); }));
  }
  if (summary.termination == TerminationType::kNoImprovement) {
    EXPECT_EQ(*state, seed);
  } else {
    // Measured anew, under the landmarks of the seed.
    ThreadPool pool(1);
    const MeasuredSurface surface =
        MeasureSurface(graph, NormalOptionsFor(options.factors.beam), &pool);
    const std::vector<double> energies = LandmarkEnergies(
        graph, options.factors,
        CutIntoLandmarks(graph, seed.poses, surface,
                         LandmarkOptionsFor(options.factors, options.association), &pool),
        {}, {&seed.poses, &state->poses}, &pool);
    // The last step, which takes the held-out returns in, goes by other landmarks.
    EXPECT_LT(energies[1], energies[0] * (1.0 + 1e-4));
  }
  return summary;
}

NoisyRoom DisturbedRoom(int num_poses = 24, double sigma = 0.02) {
  NoisyRoomOptions options;
  options.num_poses = num_poses;
  NoisyRoom room = MakeNoisyRoom(options);
  DisturbPoses(sigma, room.graph, &room.state);
  return room;
}

void AddChain(const std::vector<Pose2>& truth, int first, int last, SlamGraph* graph) {
  for (int i = first; i < last; ++i) {
    graph->AddOdometry({i, i + 1, Between(truth[i], truth[i + 1])});
  }
}

/// Root mean square of the poses' distances [m] from the truth.
double RmsError(const MapState& state, const std::vector<Pose2>& truth, int first, int last) {
  double sum = 0.0;
  for (int i = first; i <= last; ++i) {
    sum += (state.WorldFromRobot(i).translation() - truth[i].translation()).squaredNorm();
  }
  return std::sqrt(sum / (last - first + 1));
}

SyntheticScene ClosedRoom(int num_poses) {
  SyntheticScene scene;
  scene.faces = {{{3, -2}, {3, 2}}, {{3, 2}, {-3, 2}}, {{-3, 2}, {-3, -2}}, {{-3, -2}, {3, -2}}};
  scene.laser = PanoramicLaser(180);
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < num_poses; ++i) {
    const double turn = 2.0 * kPi * i / num_poses;
    scene.poses.emplace_back(1.5 * std::cos(turn), 0.8 * std::sin(turn), turn);
  }
  return scene;
}

TEST(ReducedSolveTest, ImprovesADisturbedRoom) {
  NoisyRoom room = DisturbedRoom();
  const double before_m = MeanPoseError(room);
  const SolverSummary summary = SolveSoundly(Reduced(), room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kConverged) << summary.message;
  EXPECT_LT(MeanPoseError(room), 0.4 * before_m);
  EXPECT_TRUE(summary.rounds.empty());
  EXPECT_FALSE(summary.landmark_rounds.empty());
  EXPECT_GT(summary.displacements.mean_m, 0.0);
  EXPECT_LE(summary.displacements.max_beam_sigmas,
            SolverOptions().factors.manifold.robust_gate_sigmas);
  const auto term = [&](const char* name) { return TermOfSummary(summary, name); };
  EXPECT_EQ(term(kRangeBeamTerm).count, room.graph.num_returns());
  EXPECT_EQ(term(kMotionTerm).count, 23u);
  EXPECT_LT(term(kManifoldTerm).final_cost, term(kManifoldTerm).initial_cost);
}

TEST(ReducedSolveTest, APerfectSeedInAClosedRoomMovesByMicrometres) {
  SyntheticScene scene = ClosedRoom(12);
  scene.range_sigma_m = 0.0;
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 11, &graph);
  MapState state = graph.InitialState();
  SolveSoundly(Reduced(), graph, &state);
  // Corners are not lines: a little may be gained there. Without them it comes back bit for bit,
  // see SolveWith.ReturnsAPerfectSeedBitForBit.
  for (std::size_t i = 0; i < state.poses.size(); ++i) {
    EXPECT_NEAR(state.poses[i], graph.initial_poses()[i], 1e-5);
  }
}

TEST(ReducedSolveTest, ReturnsWithoutANormalCountFromTheSecondRoundOn) {
  NoisyRoom room = MakeNoisyRoom();
  SolverOptions options = Reduced();
  MeasuredSurface surface;
  ASSERT_TRUE(MeasureNewScans(options, room.graph, &surface).ok());
  const auto count = [&] {
    MapState state = room.state;
    std::vector<std::size_t> num_observations;
    for (const LandmarkRoundSummary& round :
         RefineState(options, surface, room.graph, &state).landmark_rounds) {
      num_observations.push_back(round.num_observations);
    }
    return num_observations;
  };
  const std::vector<std::size_t> with_all = count();
  // Half of the poses see nothing that has a normal.
  const ScanEntry& half = room.graph.scan(room.graph.num_scans() / 2);
  std::fill_n(surface.normals.begin(), half.first_return, ReturnNormal());
  const std::vector<std::size_t> with_half = count();
  ASSERT_GE(with_half.size(), 3u);
  EXPECT_LT(with_half[0], with_all[0] * 6 / 10);
  for (std::size_t round = 1; round < with_half.size(); ++round) {
    EXPECT_GT(with_half[round], with_all[0] * 8 / 10) << round;
  }
  // A single round has them all.
  options.reduced.max_rounds = 1;
  const std::vector<std::size_t> at_once = count();
  ASSERT_EQ(at_once.size(), 2u);
  EXPECT_GT(at_once[0], with_all[0] * 8 / 10);
}

TEST(ReducedSolveTest, LinesThatStayHoldThePosesBack) {
  NoisyRoom follow = DisturbedRoom(), stay = DisturbedRoom();
  SolverOptions options = Reduced();
  options.reduced.max_rounds = 1;
  const SolverSummary following = SolveSoundly(options, follow.graph, &follow.state);
  options.reduced.lines_follow = false;
  const SolverSummary staying = SolveSoundly(options, stay.graph, &stay.state);
  EXPECT_LT(staying.acceptance.final_energy, staying.acceptance.seed_energy);
  EXPECT_LT(following.acceptance.final_energy, staying.acceptance.final_energy);
  options.type = SolverType::kCeres;
  options.ceres->reduced = true;
  EXPECT_THAT(RefineState(options, stay.graph, &stay.state).message, HasSubstr("lines_follow"));
}

TEST(ReducedSolveTest, SolvingAgainFindsLittleToDo) {
  NoisyRoom room = DisturbedRoom();
  SolveSoundly(Reduced(), room.graph, &room.state);
  const std::vector<double> poses = room.state.poses;
  const SolverSummary again = SolveSoundly(Reduced(), room.graph, &room.state);
  EXPECT_GT(again.acceptance.final_energy, 0.98 * again.acceptance.seed_energy);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(room.state.poses[i], poses[i], 0.01);
  }
}

TEST(ReducedSolveTest, TheCallbackStopsIt) {
  NoisyRoom room = DisturbedRoom();
  SolverOptions options = Reduced();
  int calls = 0;
  options.callback = [&](const IterationSummary& row) {
    EXPECT_EQ(row.iteration, ++calls);
    return calls < 2;
  };
  const SolverSummary summary = SolveSoundly(options, room.graph, &room.state);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped);
  EXPECT_THAT(summary.message, HasSubstr("callback"));
  EXPECT_LT(summary.acceptance.final_energy, summary.acceptance.seed_energy);
}

TEST(ReducedSolveTest, AnyNumberOfThreadsGivesTheSameBits) {
  NoisyRoom one = DisturbedRoom(130);
  const SolverSummary expected = SolveSoundly(Reduced(1), one.graph, &one.state);
  EXPECT_GT(expected.landmark_rounds.front().num_observations, 1000u);
  for (const int num_threads : {2, 3, 7}) {
    NoisyRoom many = DisturbedRoom(130);
    const SolverSummary summary = SolveSoundly(Reduced(num_threads), many.graph, &many.state);
    EXPECT_EQ(many.state, one.state);
    EXPECT_EQ(summary.final_marginal_energy, expected.final_marginal_energy);
  }
}

TEST(ReducedSolveTest, ALongHallOfManyLandmarksIsTheSameOnAnyNumberOfThreads) {
  SyntheticScene scene;
  scene.faces = {{{-100, 1.5}, {100, 1.5}}, {{-100, -1.5}, {100, -1.5}}};
  for (int x = -98; x < 100; x += 4) scene.faces.push_back({{x * 1.0, 1.0}, {x * 1.0, 1.5}});
  scene.laser = PanoramicLaser(180);
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < 280; ++i) scene.poses.emplace_back(-97.0 + 0.7 * i, 0.0, 0.0);
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 279, &graph);
  MapState one = graph.InitialState();
  DisturbPoses(0.01, graph, &one);
  MapState many = one;
  const SolverSummary summary = SolveSoundly(Reduced(1), graph, &one);
  EXPECT_GT(summary.landmark_rounds.front().num_landmarks, 256u);
  EXPECT_LT(summary.acceptance.final_energy, 0.9 * summary.acceptance.seed_energy);
  SolveSoundly(Reduced(4), graph, &many);
  EXPECT_EQ(many, one);
}

TEST(ReducedSolveTest, IslandsAreSolvedEachByItself) {
  // Two stretches without a term between them; the second sees a room of its own.
  SyntheticScene scene = ClosedRoom(24);
  for (int i = 0; i < 4; ++i) {
    const Face face = scene.faces[i];
    const Eigen::Vector2d shift(20.0, 3.0);
    scene.faces.push_back({face.a + shift, face.b + shift});
  }
  for (int i = 12; i < 24; ++i) {
    const Pose2 pose = scene.poses[i - 12];
    scene.poses[i] = {pose.x + 20.0, pose.y + 3.0, pose.yaw};
  }
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 11, &graph);
  AddChain(scene.poses, 12, 23, &graph);
  MapState state = graph.InitialState();
  DisturbPoses(0.02, graph, &state);
  const double before_m = RmsError(state, scene.poses, 0, 11);
  const MapState seed = state;
  SolveSoundly(Reduced(), graph, &state);
  EXPECT_LT(RmsError(state, scene.poses, 0, 11), 0.7 * before_m);
  // Nothing says where the second is: its first pose stays. Of itself it knows as much as the
  // first.
  for (int i = 12; i < 24; ++i) {
    const Pose2 expected = Between(scene.poses[12], scene.poses[i]);
    const Pose2 actual = Between(state.WorldFromRobot(12), state.WorldFromRobot(i));
    EXPECT_LT((actual.translation() - expected.translation()).norm(), 0.01) << i;
    EXPECT_NEAR(actual.yaw, expected.yaw, 0.01) << i;
  }
  EXPECT_LT(RmsError(state, scene.poses, 12, 23), 0.3);
  for (const int i : {3 * 12, 3 * 12 + 1, 3 * 12 + 2}) EXPECT_EQ(state.poses[i], seed.poses[i]);
}

TEST(ReducedSolveTest, PosesWithoutReturnsFollowTheirOdometry) {
  SyntheticScene scene = ClosedRoom(24);
  SlamGraph all = MakeGraph(scene), graph;
  graph.AddLaser(scene.laser);
  for (int i = 0; i < 24; ++i) {
    graph.AddPose(scene.poses[i], i);
    std::vector<double> ranges(180, kInfinity);
    for (std::size_t r = 0; r < 180; ++r) ranges[r] = all.returns().range_m[180 * i + r];
    if (i % 3 != 2 && i != 0) {
      graph.AddScan(i, 0, ranges);
    }
  }
  AddChain(scene.poses, 0, 23, &graph);
  MapState state = graph.InitialState();
  DisturbPoses(0.02, graph, &state);
  const double before_m = RmsError(state, scene.poses, 0, 23);
  SolveSoundly(Reduced(), graph, &state);
  EXPECT_LT(RmsError(state, scene.poses, 0, 23), 0.5 * before_m);
}

TEST(ReducedSolveTest, WithoutSurfacesItDoesNoHarm) {
  // Three beams of each scan hit something.
  SyntheticScene scene = ClosedRoom(8);
  scene.laser = PanoramicLaser(3);
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 7, &graph);
  MapState state = graph.InitialState();
  DisturbPoses(0.02, graph, &state);
  const SolverSummary summary = SolveSoundly(Reduced(), graph, &state);
  ASSERT_FALSE(summary.landmark_rounds.empty());
  EXPECT_EQ(summary.landmark_rounds.front().num_landmarks, 0u);
  EXPECT_LT(RmsError(state, scene.poses, 0, 7), 0.01);  // the odometry is right
}

TEST(ReducedSolveTest, OneScanIsReturnedAsItWas) {
  SyntheticScene scene = ClosedRoom(1);
  const SlamGraph graph = MakeGraph(scene);
  MapState state = graph.InitialState();
  EXPECT_EQ(SolveSoundly(Reduced(), graph, &state).termination, TerminationType::kNoImprovement);
}

TEST(ReducedSolveTest, OneReturnIsEnough) {
  SlamGraph graph;
  graph.AddPose({1, 2, 3}, 0.0);
  graph.AddLaser(PanoramicLaser(1));
  graph.AddScan(0, 0, {2.0});
  MapState state = graph.InitialState();
  EXPECT_EQ(SolveSoundly(Reduced(), graph, &state).termination, TerminationType::kNoImprovement);
}

TEST(ReducedSolveTest, TwoLasersOnARobotAgree) {
  // One looks ahead and one back, each half a circle; the scans of a pose are not side by side.
  SyntheticScene scene = ClosedRoom(16);
  LaserModel ahead = PanoramicLaser(90), back = PanoramicLaser(90);
  ahead.first_bearing_rad = back.first_bearing_rad = -0.5 * kPi;
  ahead.bearing_step_rad = back.bearing_step_rad = kPi / 90;
  ahead.robot_from_laser = {0.3, 0.05, 0.0};
  back.robot_from_laser = {-0.3, 0.0, kPi};
  Building building;
  building.faces = scene.faces;
  const World world(std::move(building));
  RandomStates random(3);
  SlamGraph graph;
  const int ids[] = {graph.AddLaser(ahead), graph.AddLaser(back)};
  for (int i = 0; i < 16; ++i) graph.AddPose(scene.poses[i], i);
  for (const LaserModel* laser : {&ahead, &back}) {
    for (int i = 0; i < 16; ++i) {
      const Pose2 from = scene.poses[i] * laser->robot_from_laser;
      std::vector<double> ranges;
      for (int beam = 0; beam < 90; ++beam) {
        ranges.push_back(world.CastRay(from.translation(), from.yaw + laser->Bearing(beam)) +
                         random.Gaussian(0.01));
      }
      graph.AddScan(i, laser == &ahead ? ids[0] : ids[1], ranges);
    }
  }
  AddChain(scene.poses, 0, 15, &graph);
  MapState state = graph.InitialState();
  DisturbPoses(0.02, graph, &state);
  const double before_m = RmsError(state, scene.poses, 0, 15);
  SolveSoundly(Reduced(), graph, &state);
  EXPECT_LT(RmsError(state, scene.poses, 0, 15), 0.4 * before_m);
}

TEST(ReducedSolveTest, FixedPosesStay) {
  SyntheticScene scene = ClosedRoom(24);
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 23, &graph);
  for (const int pose : {5, 17}) graph.FixPose(pose);
  MapState state = graph.InitialState();
  RandomStates random(2);
  for (double& coordinate : state.poses) coordinate += random.Gaussian(0.02);
  for (const int pose : {5, 17}) state.SetPose(pose, graph.InitialPose(pose));
  state.points = graph.MeasuredMap(state.poses);
  const double before_m = RmsError(state, scene.poses, 0, 23);
  SolveSoundly(Reduced(), graph, &state);
  EXPECT_LT(RmsError(state, scene.poses, 0, 23), 0.3 * before_m);
  for (const int pose : {5, 17}) EXPECT_EQ(RmsError(state, scene.poses, pose, pose), 0.0) << pose;
}

TEST(ReducedSolveTest, ALongLoopClosureBendsTheHall) {
  // Both ends of a hall of 80 m are known to each other; on the way the seed bends by 0.1 m.
  SyntheticScene scene;
  scene.faces = {{{-45, 1.5}, {45, 1.5}}, {{-45, -1.5}, {45, -1.5}}};
  for (int x = -42; x < 45; x += 6) scene.faces.push_back({{x * 1.0, 1.0}, {x * 1.0, 1.5}});
  scene.laser = PanoramicLaser(180);
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < 161; ++i) scene.poses.emplace_back(-40.0 + 0.5 * i, 0.0, 0.0);
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 160, &graph);
  graph.AddRelativePose({160, 0, Between(scene.poses[160], scene.poses[0]),
                         Eigen::Vector3d(1e-6, 1e-6, 1e-8).asDiagonal()});
  MapState state = graph.InitialState();
  for (int i = 0; i < 161; ++i) {
    const double share = i / 160.0;
    state.poses[3 * i + 1] += 0.1 * share * share;
    state.poses[3 * i + 2] += 0.2 * share / 80.0;
  }
  state.points = graph.MeasuredMap(state.poses);
  SolveSoundly(Reduced(), graph, &state);
  EXPECT_LT(RmsError(state, scene.poses, 160, 160), 0.01);
  for (int i = 0; i < 161; ++i) {
    EXPECT_NEAR(state.WorldFromRobot(i).y, 0.0, 0.02) << i;
    EXPECT_NEAR(state.WorldFromRobot(i).yaw, 0.0, 2e-3) << i;
  }
}

TEST(ReducedSolveTest, HugeCoordinatesLoseNothing) {
  SyntheticScene scene = ClosedRoom(24);
  SlamGraph all = MakeGraph(scene), graph;
  std::vector<Pose2> truth;
  graph.AddLaser(scene.laser);
  for (int i = 0; i < 24; ++i) {
    const Pose2& pose = scene.poses[i];
    truth.emplace_back(pose.x + 1e6, pose.y - 1e6, pose.yaw + 200.0 * kPi);
    graph.AddPose(truth[i], i);
    const auto first = all.returns().range_m.begin() + 180 * i;
    graph.AddScan(i, 0, std::vector<double>(first, first + 180));
  }
  AddChain(truth, 0, 23, &graph);
  MapState state = graph.InitialState();
  DisturbPoses(0.02, graph, &state);
  const double before_m = RmsError(state, truth, 0, 23);
  SolveSoundly(Reduced(), graph, &state);
  EXPECT_LT(RmsError(state, truth, 0, 23), 0.4 * before_m);
}

TEST(ReducedSolveTest, PosesBeyondAllMeasureDoNoHarm) {
  SyntheticScene scene = ClosedRoom(6);
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 5, &graph);
  MapState state = graph.InitialState();
  state.poses[3 * 4] = 9e7;
  state.poses[3 * 5 + 1] = -9e7;
  state.points = graph.MeasuredMap(state.poses);
  SolveSoundly(Reduced(), graph, &state);
}

TEST(ReducedSolveTest, HalfAndFullCirclesWork) {
  for (const double view_rad : {kPi, 2.0 * kPi}) {
    SyntheticScene scene = ClosedRoom(30);
    scene.laser.first_bearing_rad = -0.5 * view_rad;
    scene.laser.bearing_step_rad = view_rad / 180;
    SlamGraph graph = MakeGraph(scene);
    AddChain(scene.poses, 0, 29, &graph);
    MapState state = graph.InitialState();
    DisturbPoses(0.02, graph, &state);
    const double before_m = RmsError(state, scene.poses, 0, 29);
    SolveSoundly(Reduced(), graph, &state);
    EXPECT_LT(RmsError(state, scene.poses, 0, 29), 0.4 * before_m) << view_rad;
  }
}

TEST(ReducedSolveTest, AClockwiseLaserMountedUpsideDownWorks) {
  SyntheticScene scene = ClosedRoom(24);
  scene.laser.first_bearing_rad = kPi;
  scene.laser.bearing_step_rad *= -1.0;
  scene.laser.robot_from_laser = {-0.4, 0.2, -2.5};
  SlamGraph graph = MakeGraph(scene);
  AddChain(scene.poses, 0, 23, &graph);
  MapState state = graph.InitialState();
  DisturbPoses(0.02, graph, &state);
  const double before_m = RmsError(state, scene.poses, 0, 23);
  SolveSoundly(Reduced(), graph, &state);
  EXPECT_LT(RmsError(state, scene.poses, 0, 23), 0.4 * before_m);
}

TEST(ReducedSolveTest, NamesAPoseThatIsNotFinite) {
  for (const double bad : {kNaN, kInfinity}) {
    NoisyRoom room = DisturbedRoom();
    room.state.poses[3 * 7 + 1] = bad;
    const SolverSummary summary = RefineState(Reduced(), room.graph, &room.state);
    EXPECT_EQ(summary.termination, TerminationType::kFailure);
    EXPECT_THAT(summary.message, HasSubstr("pose 7"));
  }
}

TEST(ReducedSolveTest, FromAnySeedTheEnergyDoesNotRise) {
  for (const double sigma : {0.0, 0.005, 0.1, 0.5, 3.0}) {
    NoisyRoom room = DisturbedRoom(16, sigma);
    SolveSoundly(Reduced(), room.graph, &room.state);
  }
}

}  // namespace
}  // namespace plumbline
