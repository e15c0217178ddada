#include "plumbline/solvers/sliding_window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/solvers/landmarks/landmark_energy.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr int kNumPoses = 24;

// A drive around a room, at the truth.
NoisyRoom LongDrive() {
  NoisyRoomOptions options;
  options.num_poses = kNumPoses;
  return MakeNoisyRoom(options);
}

// Moves some poses by the same amount [m] and [rad] to one side and then to the other, and their
// points with them.
void Displace(const std::vector<int>& poses, double amount, NoisyRoom* room) {
  for (const int pose : poses) {
    const double by = pose % 2 == 0 ? amount : -amount;
    room->state.SetPose(pose, room->state.WorldFromRobot(pose) * Pose2(by, -by, by));
  }
  room->state.points = room->graph.MeasuredMap(room->state.poses);
}

std::vector<int> Range(int first, int end) {
  std::vector<int> range(end - first);
  std::iota(range.begin(), range.end(), first);
  return range;
}

double WorstError(const NoisyRoom& room, const std::vector<int>& poses) {
  double worst_m = 0.0;
  for (const int pose : poses) {
    worst_m = std::max(worst_m, DistanceM(room.state.WorldFromRobot(pose), room.truth[pose]));
  }
  return worst_m;
}

SolverOptions Options(SolverType type = SolverType::kReduced, int num_threads = 1) {
  SolverOptions options;
  options.type = type;
  options.num_threads = num_threads;
  return options;
}

WindowOptions Newest(int num_free_poses) {
  WindowOptions window;
  window.num_free_poses = num_free_poses;
  return window;
}

// All but `free_poses` and their points are the same bits.
void ExpectOthersUntouched(const MapState& before, const NoisyRoom& after,
                           const std::vector<int>& free_poses) {
  std::vector<char> is_free(before.num_poses());
  for (const int pose : free_poses) is_free[pose] = true;
  for (std::size_t i = 0; i < before.poses.size(); ++i) {
    if (!is_free[i / 3]) {
      EXPECT_EQ(before.poses[i], after.state.poses[i]) << "pose " << i / 3;
    }
  }
  for (std::size_t i = 0; i < before.points.size(); ++i) {
    const int pose = after.graph.scan(after.graph.ScanOfReturn(i / 2)).pose;
    if (!is_free[pose]) {
      ASSERT_EQ(before.points[i], after.state.points[i]) << "a point of " << pose;
    }
  }
}

TEST(SlidingWindowTest, TheNewestPosesFindTheirPlaceAndOlderOnesStay) {
  NoisyRoom room = LongDrive();
  const std::vector<int> newest = Range(16, kNumPoses);
  Displace(newest, 0.05, &room);
  const MapState before = room.state;
  const SolverSummary summary = SolveWindow(Options(), Newest(8), room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_LT(summary.acceptance.final_energy, summary.acceptance.seed_energy);
  EXPECT_GT(WorstError({room.graph, room.truth, before}, newest), 0.06);
  EXPECT_LT(WorstError(room, newest), 0.01);
  EXPECT_NE(room.state.points.back(), before.points.back());
  ExpectOthersUntouched(before, room, newest);
}

// The energy of the whole map falls, too.
TEST(SlidingWindowTest, AWindowImprovesTheWholeMap) {
  NoisyRoom room = LongDrive();
  Displace(Range(16, kNumPoses), 0.02, &room);
  const MapState before = room.state;
  ASSERT_TRUE(SolveWindow(Options(), Newest(8), room.graph, &room.state).IsSolutionUsable());
  ThreadPool pool(1);
  const FactorOptions factors;
  const MeasuredSurface surface = SurfaceOf(room.graph);
  const LineLandmarks cut = CutIntoLandmarks(
      room.graph, before.poses, surface, LandmarkOptionsFor(factors, AssociationOptions()), &pool);
  const std::vector<double> energies =
      LandmarkEnergies(room.graph, factors, cut, {}, {&before.poses, &room.state.poses}, &pool);
  EXPECT_LT(energies[1], 0.7 * energies[0]);
}

TEST(SlidingWindowTest, AnySetOfPosesCanBeSolvedFor) {
  for (const SolverType type :
       {SolverType::kReduced, SolverType::kAlternatingCg, SolverType::kCeres}) {
    NoisyRoom room = LongDrive();
    const std::vector<int> changed = {17, 4, 5};  // in any order
    Displace(changed, 0.03, &room);
    const MapState before = room.state;
    const SolverSummary summary =
        SolvePoses(Options(type), WindowOptions(), changed, room.graph, &room.state);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_LT(WorstError(room, changed), 0.01) << ToString(type);
    ExpectOthersUntouched(before, room, changed);
  }
}

TEST(SlidingWindowTest, AWindowAsLongAsTheGraphIsSolve) {
  for (const SolverType type : {SolverType::kReduced, SolverType::kAlternatingCg}) {
    NoisyRoom room = MakeNoisyRoom();
    DisturbPoses(0.02, room.graph, &room.state);
    room.graph.FixPose(3, room.state.WorldFromRobot(3));
    room.state.SetPose(3, room.state.WorldFromRobot(3) * Pose2(0.01, 0.0, 0.0));
    MapState whole = room.state;
    const SolverSummary expected = RefineState(Options(type), room.graph, &whole);
    const SolverSummary summary =
        SolveWindow(Options(type), WindowOptions(), room.graph, &room.state);
    EXPECT_EQ(room.state, whole) << ToString(type);
    EXPECT_EQ(summary.message, expected.message);
    EXPECT_EQ(summary.final_marginal_energy, expected.final_marginal_energy);
  }
}

TEST(SlidingWindowTest, SurfacesMeasuredAsScansArriveGiveTheSameResult) {
  NoisyRoom room = LongDrive();
  Displace(Range(16, kNumPoses), 0.02, &room);
  MeasuredSurface whole, surface;
  ASSERT_TRUE(MeasureNewScans(Options(), room.graph, &whole).ok());
  surface.normals.assign(whole.normals.begin(),
                         whole.normals.begin() + room.graph.scan(10).first_return);
  ASSERT_TRUE(MeasureNewScans(Options(), room.graph, &surface).ok());
  ASSERT_TRUE(MeasureNewScans(Options(), room.graph, &surface).ok());  // nothing is new
  EXPECT_EQ(surface.normals, whole.normals);
  NoisyRoom unmeasured = room;
  ASSERT_TRUE(
      SolveWindow(Options(), Newest(8), unmeasured.graph, &unmeasured.state).IsSolutionUsable());
  ASSERT_TRUE(
      SolveWindow(Options(), Newest(8), surface, room.graph, &room.state).IsSolutionUsable());
  EXPECT_EQ(room.state.poses, unmeasured.state.poses);
  EXPECT_EQ(room.state.points, unmeasured.state.points);
}

TEST(SlidingWindowTest, ASurfaceOfAnotherGraphIsAnError) {
  NoisyRoom room = LongDrive();
  const MapState before = room.state;
  MeasuredSurface surface;
  const SolverSummary summary = SolveWindow(Options(), Newest(8), surface, room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_THAT(summary.message, HasSubstr("but the surface 0 normals"));
  EXPECT_EQ(room.state.poses, before.poses);
  surface.normals.resize(room.graph.num_returns() + 1);
  EXPECT_THAT(MeasureNewScans(Options(), room.graph, &surface).message(), HasSubstr("normals"));
  EXPECT_EQ(surface.normals.size(), room.graph.num_returns() + 1);
  EXPECT_THAT(MeasureNewScans(Options(SolverType::kReduced, 0), room.graph, &surface).message(),
              HasSubstr("num_threads"));
}

TEST(SlidingWindowTest, AFixedPoseIsHeldWhereItWasFixedAlsoInAWindow) {
  for (const SolverType type :
       {SolverType::kReduced, SolverType::kAlternatingCg, SolverType::kCeres}) {
    NoisyRoom room = LongDrive();
    const std::vector<int> newest = Range(16, kNumPoses);
    Displace(newest, 0.03, &room);
    room.graph.FixPose(20, room.truth[20]);
    room.graph.FixPose(3, {9.0, 9.0, 9.0});  // not of this window
    const MapState before = room.state;
    const SolverSummary summary = SolveWindow(Options(type), Newest(8), room.graph, &room.state);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_EQ(ToBlock(room.state.WorldFromRobot(20)), ToBlock(room.truth[20])) << ToString(type);
    EXPECT_LT(WorstError(room, newest), 0.01) << ToString(type);
    ExpectOthersUntouched(before, room, newest);
  }
}

TEST(SlidingWindowTest, TheResultDoesNotDependOnTheNumberOfThreads) {
  NoisyRoom room = LongDrive();
  Displace(Range(12, kNumPoses), 0.03, &room);
  MapState other = room.state;
  ASSERT_TRUE(SolveWindow(Options(), Newest(12), room.graph, &room.state).IsSolutionUsable());
  ASSERT_TRUE(SolveWindow(Options(SolverType::kReduced, 3), Newest(12), room.graph, &other)
                  .IsSolutionUsable());
  EXPECT_EQ(room.state, other);
}

TEST(SlidingWindowTest, AWindowAtItsOptimumHardlyMoves) {
  NoisyRoom room = LongDrive();
  double moved_m = 1.0;
  for (int i = 0; i < 20; ++i) {
    const MapState before = room.state;
    const SolverSummary summary = SolveWindow(Options(), Newest(8), room.graph, &room.state);
    ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
    EXPECT_TRUE(summary.acceptance.LowersEnergy() ||
                summary.termination == TerminationType::kNoImprovement);
    if (summary.termination == TerminationType::kNoImprovement) {
      EXPECT_EQ(room.state, before);
    }
    moved_m = 0.0;
    for (int pose = 0; pose < room.graph.num_poses(); ++pose) {
      const Pose2 step = Between(before.WorldFromRobot(pose), room.state.WorldFromRobot(pose));
      moved_m = std::max(moved_m, step.translation().norm());
    }
  }
  EXPECT_LT(moved_m, 1e-4);
}

TEST(SlidingWindowTest, TheCallbackCanStopIt) {
  NoisyRoom room = LongDrive();
  Displace(Range(16, kNumPoses), 0.05, &room);
  SolverOptions options = Options();
  int num_calls = 0;
  options.callback = [&](const IterationSummary&) { return ++num_calls < 1; };
  const SolverSummary summary = SolveWindow(options, Newest(8), room.graph, &room.state);
  EXPECT_EQ(summary.termination, TerminationType::kUserStopped);
  EXPECT_EQ(num_calls, 1);
}

TEST(SlidingWindowTest, AWindowIsNoLargerThanItsOptionsSay) {
  NoisyRoom room = LongDrive();
  WindowOptions window = Newest(5);
  window.max_fixed_poses = 6;
  const SolverSummary summary = SolveWindow(Options(), window, room.graph, &room.state);
  // One fixed pose for the odometry, one for the closure of the last pose to the first.
  EXPECT_LE(summary.num_poses, 5u + 6u + 2u);
  EXPECT_GE(summary.num_poses, 5u + 6u);
}

// A closure of the host counts although its other end is far away.
TEST(SlidingWindowTest, ConstraintsOnOlderPosesCount) {
  SlamGraph graph;
  const int laser = graph.AddLaser(PanoramicLaser(4));
  for (int i = 0; i < 3; ++i) graph.AddPose({50.0 * i, 0.0, 0.0}, i);
  graph.AddScan(2, laser, {1.0, 1.0, 1.0, 1.0});
  graph.AddRelativePose({0, 2, Pose2(100.2, 0.1, 0.0), Eigen::Matrix3d::Identity() * 1e-4});
  WindowOptions window = Newest(1);
  window.max_fixed_poses = 0;
  MapState state = graph.InitialState();
  const SolverSummary summary = SolveWindow(Options(), window, graph, &state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_NEAR(state.WorldFromRobot(2).x, 100.2, 1e-9);
  EXPECT_NEAR(state.WorldFromRobot(2).y, 0.1, 1e-9);
  EXPECT_NEAR(state.points[1], 0.1, 1e-6);
  EXPECT_EQ(state.WorldFromRobot(1).x, 50.0);
}

TEST(SlidingWindowTest, PosesWithoutScansAndScansWithoutReturnsFollowTheirOdometry) {
  NoisyRoom room = LongDrive();
  SlamGraph& graph = room.graph;
  const Pose2 step(0.2, 0.0, 0.1);
  int pose = 0;
  for (const bool has_scan : {false, true}) {
    pose = graph.AddPose({5.0, 5.0, 0.0}, 100.0 + has_scan);
    graph.AddOdometry({pose - 1, pose, step});
    if (has_scan) {
      graph.AddScan(pose, 0, std::vector<double>(180, 1e9));
    }
  }
  graph.ExtendState(&room.state);
  const SolverSummary summary = SolveWindow(Options(), Newest(2), graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  const Pose2 expected = room.state.WorldFromRobot(pose - 2) * step * step;
  EXPECT_LT(DistanceM(room.state.WorldFromRobot(pose), expected), 1e-6);
}

TEST(SlidingWindowTest, AnIslandKeepsItsFirstPose) {
  // The second half drives through a room of its own that nothing ties to the first.
  SyntheticScene scene = Room();
  const SyntheticScene first_room = scene;
  for (const Face& face : first_room.faces) {
    scene.faces.push_back({face.a + Eigen::Vector2d(20, 0), face.b + Eigen::Vector2d(20, 0)});
  }
  scene.range_sigma_m = 0.005;
  for (int i = 0; i < 12; ++i) {
    scene.poses.push_back({(i < 6 ? -1.0 : 19.0) + 0.2 * (i % 6), 0.05 * i, 0.1 * i});
  }
  NoisyRoom room{MakeGraph(scene), scene.poses, {}};
  room.state = room.graph.InitialState();
  Displace({7, 8, 9, 10, 11}, 0.02, &room);
  const MapState before = room.state;
  const SolverSummary summary = SolveWindow(Options(), Newest(6), room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_EQ(summary.num_poses, 6u);
  EXPECT_EQ(ToBlock(room.state.WorldFromRobot(6)), ToBlock(before.WorldFromRobot(6)));
  EXPECT_LT(WorstError(room, Range(6, 12)), 0.01);
  ExpectOthersUntouched(before, room, Range(6, 12));
}

TEST(SlidingWindowTest, BadInputIsNamedAndChangesNothing) {
  NoisyRoom room = MakeNoisyRoom();
  const SlamGraph& graph = room.graph;
  MapState& state = room.state;
  const auto expect_failure = [&](const std::vector<int>& poses, const WindowOptions& window,
                                  const SolverOptions& options, const char* message) {
    const MapState before = state;
    const SolverSummary summary = SolvePoses(options, window, poses, graph, &state);
    EXPECT_EQ(summary.termination, TerminationType::kFailure);
    EXPECT_THAT(summary.message, HasSubstr(message));
    EXPECT_EQ(state.points, before.points);
  };
  const WindowOptions good;
  expect_failure({}, good, Options(), "no free poses");
  expect_failure({1, 12}, good, Options(), "free pose 12: the graph has 12 poses");
  expect_failure({-1}, good, Options(), "free pose -1");
  expect_failure({5, 6, 5}, good, Options(), "free pose 5 is named twice");
  expect_failure({8}, good, Options(SolverType::kReduced, 0), "num_threads");
  WindowOptions bad;
  bad.max_fixed_poses = -1;
  expect_failure({8}, bad, Options(), "window.max_fixed_poses");

  state.points[2 * graph.scan(4).first_return] = 1e300;
  expect_failure({4}, good, Options(), "a point of scan 4 is not finite");
  expect_failure({5}, good, Options(), "a point of scan 4 is not finite");
  state.SetPose(2, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  expect_failure({2}, good, Options(), "pose 2 of the state is not finite");
  expect_failure({1}, good, Options(), "pose 2 of the state is not finite");  // its neighbour
  state.poses.resize(state.poses.size() - 3);  // as if the graph had grown
  expect_failure({1}, good, Options(), "see SlamGraph::ExtendState");
}

// The indices of the graph's constraints are not those of the window's.
TEST(SlidingWindowTest, WhatIsIgnoredAndDownweightedIsSoInAWindow) {
  const auto off_m = [](const NoisyRoom& from, const SolverOptions& options) {
    NoisyRoom room = from;
    EXPECT_TRUE(SolveWindow(options, Newest(6), room.graph, &room.state).IsSolutionUsable());
    return DistanceM(room.state.WorldFromRobot(20), room.truth[20]);
  };
  NoisyRoom room = LongDrive();
  Displace(Range(18, 24), 0.03, &room);
  const std::size_t wrong_edge = room.graph.relative_poses().size();
  const Pose2 motion = Between(room.truth[19], room.truth[20]) * Pose2(0.3, 0.0, 0.0);
  room.graph.AddRelativePose({19, 20, motion, 1e-9 * Eigen::Matrix3d::Identity()});
  SolverOptions options = Options();
  EXPECT_GT(off_m(room, options), 0.05);  // a window does not test edges
  options.factors.ignored_relative_poses = {wrong_edge};
  EXPECT_LT(off_m(room, options), 0.01);

  NoisyRoom slipped = LongDrive();
  Displace(Range(18, 24), 0.03, &slipped);
  std::vector<Pose2> steps;
  for (const OdometryConstraint& c : slipped.graph.odometry()) steps.push_back(c.from_from_to);
  steps[19].x += 0.3;
  slipped.graph = slipped.graph.Corrected({steps, {}, {}, {}, {}});
  options = Options();
  options.factors.motion = {0.0, 0.0, 0.0, 0.0, 1e-3, 1e-3};
  EXPECT_GT(off_m(slipped, options), 0.1);
  options.factors.downweighted_steps = {{19, 1e4}};
  EXPECT_LT(off_m(slipped, options), 0.02);
}

TEST(SlidingWindowTest, AGraphWithoutPosesOrReturnsIsAnError) {
  SlamGraph graph;
  MapState state;
  EXPECT_THAT(SolveWindow(Options(), Newest(5), graph, &state).message, HasSubstr("no free poses"));
  EXPECT_THAT(SolveWindow(Options(), Newest(0), graph, &state).message,
              HasSubstr("window.num_free_poses"));
  graph.AddPose({1.0, 2.0, 3.0}, 0.0);
  graph.ExtendState(&state);
  const SolverSummary summary = SolveWindow(Options(), Newest(5), graph, &state);
  EXPECT_EQ(summary.termination, TerminationType::kFailure);
  EXPECT_THAT(summary.message, HasSubstr("no laser returns"));
}

}  // namespace
}  // namespace plumbline
