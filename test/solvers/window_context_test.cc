#include "plumbline/solvers/window_context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr int kNumPoses = 40;

// Down a hall of 45 m, a scan every metre; it sees 8 m far.
SlamGraph Hall() {
  SyntheticScene scene;
  scene.faces = Rectangle({-2.0, -2.0}, {43.0, 2.0});
  scene.laser = PanoramicLaser(360);
  scene.laser.max_range_m = 8.0;
  for (int i = 0; i < kNumPoses; ++i) scene.poses.push_back({1.0 * i, 0.0, 0.0});
  return MakeGraph(scene);
}

TEST(WindowContextTest, TheNearestPosesThatSawTheSame) {
  const SlamGraph graph = Hall();
  const MapState state = graph.InitialState();
  WindowOptions options;
  options.max_fixed_poses = 3;
  EXPECT_THAT(ChooseFixedPoses(options, graph, state, {38, 39}), ElementsAre(35, 36, 37));
  EXPECT_THAT(ChooseFixedPoses(options, graph, state, {20}), ElementsAre(18, 19, 21));
  options.max_fixed_poses = 100;
  const std::vector<int> fixed = ChooseFixedPoses(options, graph, state, {39});
  EXPECT_THAT(fixed, Contains(36));
  EXPECT_THAT(fixed, Each(Ge(28)));  // 11 m away, a tenth of the returns is common
}

TEST(WindowContextTest, PosesBehindAWallAreNotTaken) {
  SyntheticScene scene;
  scene.faces = Rectangle({-3.0, -2.0}, {-0.6, 2.0});
  for (const Face& face : Rectangle({0.6, -2.0}, {3.0, 2.0})) scene.faces.push_back(face);
  scene.poses = {{-2.0, 0.0, 0.0}, {-1.5, 0.5, 0.0}, {1.5, 0.0, 0.0}, {2.0, 0.5, 0.0}};
  const SlamGraph graph = MakeGraph(scene);
  EXPECT_THAT(ChooseFixedPoses(WindowOptions(), graph, graph.InitialState(), {3}), ElementsAre(2));
}

TEST(WindowContextTest, OneOfAllThatStoodThereAndLookedThatWay) {
  SyntheticScene scene = Room();
  for (int i = 0; i < 10; ++i) scene.poses.push_back({0.51 + 0.02 * i, 0.6, 0.02 * i});
  scene.poses.push_back({0.6, 0.6, 2.0});  // looks elsewhere
  scene.poses.push_back({0.0, 0.6, 0.0});
  const SlamGraph graph = MakeGraph(scene);
  EXPECT_THAT(ChooseFixedPoses(WindowOptions(), graph, graph.InitialState(), {11}),
              ElementsAre(0, 10));
}

TEST(WindowContextTest, APoseThatSawNothingDoesNotStandForItsNeighbours) {
  SyntheticScene scene = Room();
  scene.poses.push_back({0.0, 0.6, 0.0});
  scene.poses.push_back({0.3, 0.6, 0.0});
  SlamGraph graph = MakeGraph(scene);
  const int blind = graph.AddPose({0.01, 0.6, 0.0}, 99.0);
  MapState state = graph.InitialState();
  EXPECT_THAT(ChooseFixedPoses(WindowOptions(), graph, state, {1}), ElementsAre(0));
  // Nearer to the window than the pose that saw it.
  state.SetPose(blind, {0.1, 0.6, 0.0});
  EXPECT_THAT(ChooseFixedPoses(WindowOptions(), graph, state, {1}), ElementsAre(0));
}

// A square so large that poses 15 m apart see the same walls.
TEST(WindowContextTest, FarPosesDoNotCountUnlessAConstraintTiesThem) {
  SyntheticScene scene;
  scene.faces = Rectangle({-30.0, -30.0}, {30.0, 30.0});
  scene.laser = PanoramicLaser(720);
  scene.laser.max_range_m = 100.0;
  for (int i = 0; i < 40; ++i) scene.poses.push_back({-20.0 + 1.0 * i, 0.0, 0.0});
  SlamGraph graph = MakeGraph(scene);
  WindowOptions options;
  const std::vector<int> near = ChooseFixedPoses(options, graph, graph.InitialState(), {39});
  EXPECT_THAT(near, Contains(20));
  EXPECT_THAT(near, Each(Ge(19)));
  graph.AddOdometry({20, 21, Pose2(1.0, 0.0, 0.0)});  // not of this window
  graph.AddRelativePose({39, 0, Pose2(-39.0, 0.0, 0.0), Eigen::Matrix3d::Identity()});
  EXPECT_THAT(ChooseFixedPoses(options, graph, graph.InitialState(), {39}), Contains(0));
  options.max_fixed_poses = 0;
  EXPECT_THAT(ChooseFixedPoses(options, graph, graph.InitialState(), {39}), ElementsAre(0));
}

TEST(WindowContextTest, PosesOutOfReachAreNotTaken) {
  const SlamGraph graph = Hall();
  MapState state = graph.InitialState();
  state.SetPose(38, {38.0, 0.0, std::numeric_limits<double>::quiet_NaN()});
  const ScanEntry& scan = graph.scan(37);
  for (std::size_t i = 2 * scan.first_return; i < 2 * (scan.first_return + scan.num_returns); ++i) {
    state.points[i] = 1e300;
  }
  const std::vector<int> fixed = ChooseFixedPoses(WindowOptions(), graph, state, {39});
  EXPECT_THAT(fixed, Contains(36));
  EXPECT_THAT(fixed, Not(Contains(37)));
  EXPECT_THAT(fixed, Not(Contains(38)));
}

TEST(WindowContextTest, APoseWithoutReturnsHasNoContext) {
  SlamGraph graph = Hall();
  const int pose = graph.AddPose({39.5, 0.0, 0.0}, 100.0);
  EXPECT_THAT(ChooseFixedPoses(WindowOptions(), graph, graph.InitialState(), {pose}), IsEmpty());
}

}  // namespace
}  // namespace plumbline
