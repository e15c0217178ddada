#include "plumbline/solvers/front_end/pairwise_icp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <string>
#include <vector>

#include "plumbline/test/core/initial_guesses.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

PairwiseIcpOptions OptionsFor(IcpMetric metric) {
  PairwiseIcpOptions options;
  options.metric = metric;
  return options;
}

// 720 beams all around, from places 2 m apart in two rooms with a door between them.
SyntheticScene TwoRooms(double range_sigma_m) {
  SyntheticScene scene;
  scene.faces = Rectangle({-4.0, -3.0}, {10.0, 3.0});
  const std::vector<Face> inside = {{{3.0, -3.0}, {3.0, -0.8}}, {{3.0, 0.8}, {3.0, 3.0}},
                                    {{-4.0, 1.5}, {-2.5, 1.5}}, {{-2.5, 1.5}, {-2.5, 3.0}},
                                    {{7.0, -3.0}, {7.0, -1.8}}, {{7.0, -1.8}, {8.2, -1.8}}};
  scene.faces.insert(scene.faces.end(), inside.begin(), inside.end());
  scene.discs = {{{0.5, 2.2}, 0.3}, {{6.0, 2.0}, 0.4}};
  for (int i = 0; i < 5; ++i) scene.poses.emplace_back(-2.0 + 2.0 * i, 0.1 * i, 0.25 * i);
  scene.range_sigma_m = range_sigma_m;
  return scene;
}

class PairwiseIcpTest : public testing::TestWithParam<IcpMetric> {};
INSTANTIATE_TEST_SUITE_P(Metrics, PairwiseIcpTest,
                         testing::Values(IcpMetric::kPointToPoint, IcpMetric::kPointToLine),
                         [](const auto& info) {
                           return std::string(info.param == IcpMetric::kPointToPoint
                                                  ? "point_to_point"
                                                  : "point_to_line");
                         });

TEST_P(PairwiseIcpTest, FindsTheMotionBetweenScansMetresApart) {
  const SyntheticScene scene = TwoRooms(0.02);
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  const double tolerance_m = GetParam() == IcpMetric::kPointToLine ? 0.02 : 0.1;
  for (std::size_t i = 1; i < scene.poses.size(); ++i) {
    const Pose2 truth = Between(scene.poses[i - 1], scene.poses[i]);
    const Pose2 guess = truth * Pose2(0.2, -0.15, 0.06);
    const PairMatch match = MatchPair(surfaces[i - 1], surfaces[i], guess, OptionsFor(GetParam()));
    EXPECT_LT(DistanceM(match.from_from_to, truth), tolerance_m) << i;
    EXPECT_NEAR(match.from_from_to.yaw, truth.yaw, 0.02) << i;
    EXPECT_TRUE(match.converged) << i;
    EXPECT_GT(match.inlier_ratio, 0.5) << i;
    EXPECT_EQ(match.covariance.llt().info(), Eigen::Success);
    EXPECT_LT(match.covariance(0, 0), 0.02 * 0.02);
  }
}

TEST_P(PairwiseIcpTest, AScanMatchedWithItselfStays) {
  SyntheticScene scene = TwoRooms(0.0);
  const SurfacePoints scan = SurfacesOf(MakeGraph(scene))[1];
  const PairMatch match = MatchPair(scan, scan, Pose2(0.1, -0.05, 0.03), OptionsFor(GetParam()));
  // Points 3 cm apart can lock in next to their own.
  const bool by_lines = GetParam() == IcpMetric::kPointToLine;
  EXPECT_LT(DistanceM(match.from_from_to, Pose2()), by_lines ? 0.002 : 0.02);
  EXPECT_NEAR(match.from_from_to.yaw, 0.0, by_lines ? 0.001 : 0.005);
  EXPECT_GT(match.inlier_ratio, 0.99);
}

// Two walls hold the robot across and in its heading; along them the guess stands, or the ends of
// what is seen pull a little, and the covariance says that nothing is known.
TEST_P(PairwiseIcpTest, ABareCorridorIsKnownAcrossOnly) {
  SyntheticScene scene;
  scene.faces = {{{-50.0, -1.0}, {50.0, -1.0}}, {{50.0, 1.0}, {-50.0, 1.0}}};
  scene.laser.max_range_m = 6.0;
  scene.poses = {Pose2(), Pose2(0.3, 0.05, 0.02)};
  const std::vector<SurfacePoints> surfaces = SurfacesOf(MakeGraph(scene));
  const PairMatch match =
      MatchPair(surfaces[0], surfaces[1], Pose2(0.25, 0.0, 0.0), OptionsFor(GetParam()));
  EXPECT_NEAR(match.from_from_to.y, 0.05, 0.01);
  EXPECT_NEAR(match.from_from_to.yaw, 0.02, 0.01);
  EXPECT_GT(match.covariance(0, 0), 0.1);
  EXPECT_LT(match.covariance(1, 1), 1e-3);
  const double pull_m = GetParam() == IcpMetric::kPointToLine ? 0.01 : 0.25;
  EXPECT_NEAR(match.from_from_to.x, 0.25, pull_m);
}

TEST_P(PairwiseIcpTest, WithoutPointsTheGuessStands) {
  const SurfacePoints scan = SurfacesOf(MakeGraph(TwoRooms(0.0)))[0];
  const Pose2 guess(1.0, 2.0, 0.5), far(100.0, 0.0, 0.0);
  const PairwiseIcpOptions options = OptionsFor(GetParam());
  for (const PairMatch& match :
       {MatchPair({}, scan, guess, options), MatchPair(scan, {}, guess, options),
        MatchPair({}, {}, guess, options)}) {
    EXPECT_EQ(match.from_from_to.x, 1.0);
    EXPECT_EQ(match.from_from_to.yaw, 0.5);
    EXPECT_EQ(match.inlier_ratio, 0.0);
    EXPECT_FALSE(match.converged);
  }
  const PairMatch match = MatchPair(scan, scan, far, options);
  EXPECT_NEAR(match.from_from_to.x, 100.0, 1e-9);
  EXPECT_EQ(match.inlier_ratio, 0.0);
}

TEST_P(PairwiseIcpTest, ChainsPairsFromTheOdometry) {
  const SyntheticScene scene = TwoRooms(0.02);
  SlamGraph drive = MakeGraph(scene);
  AddOdometry([](const Pose2& step) { return step * Pose2(0.15, -0.1, 0.05); }, &drive);
  std::vector<Pose2> guesses(scene.poses.size(), Pose2(7.0, 7.0, 7.0));
  guesses[0] = scene.poses[0];
  const SlamGraph graph = WithInitialPoses(drive, guesses);
  ThreadPool pool(2), one(1);
  MapState state, same;
  const PairwiseIcpOptions options = OptionsFor(GetParam());
  const MeasuredSurface surface = SurfaceOf(graph);
  ASSERT_TRUE(ChainPairs(options, surface, &pool, graph, &state).ok());
  EXPECT_EQ(state.WorldFromRobot(0).x, scene.poses[0].x);
  const double tolerance_m = GetParam() == IcpMetric::kPointToLine ? 0.04 : 0.25;
  EXPECT_LT(DistanceM(state.WorldFromRobot(4), scene.poses[4]), tolerance_m);
  const std::size_t last = graph.num_returns() - 1;
  EXPECT_LT((MapPoint(state, last) - state.WorldFromRobot(4) * graph.PointInRobot(last)).norm(),
            1e-9);
  ASSERT_TRUE(ChainPairs(options, surface, &one, graph, &same).ok());
  EXPECT_EQ(same, state);
}

// Scans 1 and 2 see nothing, scan 4 sees another world.
TEST_P(PairwiseIcpTest, TheOdometryStandsWhereScansDoNotMatch) {
  SyntheticScene scene = TwoRooms(0.01);
  scene.poses.assign(5, Pose2());
  for (int i = 0; i < 5; ++i) scene.poses[i].x = 0.1 * i;
  SyntheticScene elsewhere = scene;
  elsewhere.faces = {{{0.5, -0.4}, {0.5, 0.4}}};
  elsewhere.discs.clear();
  SlamGraph graph;
  const int laser = graph.AddLaser(scene.laser);
  const SlamGraph here = MakeGraph(scene), there = MakeGraph(elsewhere);
  for (int i = 0; i < 5; ++i) {
    const int id = graph.AddPose(scene.poses[i], i);
    const SlamGraph& seen = i == 4 ? there : here;
    const double no_return = scene.laser.max_range_m + 1.0;
    std::vector<double> ranges = seen.RangesOfScan(i, no_return);
    if (i == 1 || i == 2) ranges.assign(ranges.size(), no_return);
    graph.AddScan(id, laser, ranges);
  }
  AddOdometry([](const Pose2& step) { return Pose2(step.x + 0.02, 0.0, 0.0); }, &graph);
  ThreadPool pool(1);
  MapState state;
  ASSERT_TRUE(ChainPairs(OptionsFor(GetParam()), SurfaceOf(graph), &pool, graph, &state).ok());
  EXPECT_NEAR(state.WorldFromRobot(1).x, 0.12, 1e-9);
  EXPECT_NEAR(state.WorldFromRobot(2).x, 0.24, 1e-9);
  EXPECT_NEAR(state.WorldFromRobot(3).x, 0.3, 0.015);  // matched to the first
  const Pose2 expected = state.WorldFromRobot(3) * Pose2(0.12, 0.0, 0.0);
  EXPECT_LT(DistanceM(state.WorldFromRobot(4), expected), 1e-9);
}

TEST(PairwiseIcp, NamesWhatIsWrongAndLeavesTheStateAsItWas) {
  SyntheticScene scene = Room();
  scene.poses = {Pose2(), Pose2(0.1, 0.0, 0.0)};
  const SlamGraph graph = MakeGraph(scene);
  MapState state = graph.InitialState();
  MeasuredSurface surface = SurfaceOf(graph);
  ThreadPool pool(1);
  PairwiseIcpOptions options;
  const auto expect_failure = [&](const std::string& culprit) {
    const Status status = ChainPairs(options, surface, &pool, graph, &state);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr(culprit));
    EXPECT_EQ(state, graph.InitialState());
  };
  expect_failure("odometry from pose 0 to pose 1");
  surface.normals.pop_back();
  expect_failure("one normal per return");
  options.gate_m = 0.01;
  expect_failure("gate_m = 0.01");
  options = PairwiseIcpOptions();
  options.sigma_m = 0.0;
  expect_failure("sigma_m = 0");
}

}  // namespace
}  // namespace plumbline
