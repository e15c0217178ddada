#include "plumbline/solvers/loop_closure/loop_closure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

// A first visit from all poses of the scene but the last one, 1 m of path apart, and 50 m later a
// second one from there, which is believed to be `error` off. Tests the last of the first visit
// with the second; a wide search looks around all of the first visit.
TestedCandidate TestLast(const SyntheticScene& scene, const Pose2& error, double drift_m,
                         bool wide) {
  const SlamGraph graph = MakeGraph(scene);
  const int second = graph.num_poses() - 1;
  KeyframeGraph keys;
  keys.keyframes.resize(second + 1);
  keys.world_from_key = scene.poses;
  keys.world_from_key[second] = error * keys.world_from_key[second];
  keys.sequential.resize(second);
  LoopCandidate candidate{second - 1, second, drift_m, 0.25, {}};
  for (int k = 0; k <= second; ++k) {
    keys.keyframes[k].pose = keys.keyframes[k].scan = k;
    keys.keyframes[k].path_m = k < second ? k : 50.0 + k;
    if (wide && k < second) candidate.surroundings.push_back(k);
  }
  ThreadPool pool(2);
  return TestLoopCandidates(ScanSurfaces(graph, Packed(SurfacesOf(graph))), keys, {candidate},
                            &pool)
      .front();
}

TEST(LoopClosure, MeasuresARevisit) {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  scene.poses = {Pose2(), Pose2(0.6, 0.4, 0.3)};
  for (const bool wide : {false, true}) {
    const TestedCandidate tested = TestLast(scene, Pose2(1.1, -0.8, 0.1), 1.65, wide);
    ASSERT_EQ(tested.outcome, ClosureOutcome::kAccepted);
    EXPECT_EQ(tested.edge.from, 0);
    EXPECT_EQ(tested.edge.to, 1);
    EXPECT_LT(DistanceM(tested.edge.from_from_to, scene.poses[1]), 0.01);
    EXPECT_NEAR(tested.edge.from_from_to.yaw, 0.3, 3e-3);
  }
}

// Steps of 5 cm in the walls of a corridor tell where it is to some decimetres.
TEST(LoopClosure, SaysHowBadlyAPoseAlongACorridorIsKnown) {
  SyntheticScene scene;
  scene.range_sigma_m = 0.02;
  scene.laser.max_range_m = 8.0;
  for (const double side : {-1.0, 1.0}) {
    const double step = 3.0 + side;
    scene.faces.push_back({{-50.0, side}, {step, side}});
    scene.faces.push_back({{step, side}, {step, 1.05 * side}});
    scene.faces.push_back({{step, 1.05 * side}, {50.0, 1.05 * side}});
  }
  scene.poses = {Pose2(), Pose2(1.0, 0.0, 0.0), Pose2(1.2, 0.0, 0.0)};
  const TestedCandidate tested = TestLast(scene, Pose2(0.3, 0.0, 0.0), 0.5, /*wide=*/false);
  ASSERT_EQ(tested.outcome, ClosureOutcome::kAccepted);
  const Eigen::Matrix3d& covariance = tested.edge.covariance;
  EXPECT_GT(covariance(0, 0), 0.1 * 0.1);
  EXPECT_LT(covariance(0, 0), 1.0);
  EXPECT_LT(covariance(1, 1), 0.02 * 0.02);
  EXPECT_LT(std::abs(tested.edge.from_from_to.x - 0.2), 2.0 * std::sqrt(covariance(0, 0)));
}

TEST(LoopClosure, RejectsARoomOfAnotherShape) {
  SyntheticScene scene = Room();
  const std::vector<Face> other = Rectangle({97.5, -1.2}, {105.0, 1.2});
  scene.faces.insert(scene.faces.end(), other.begin(), other.end());
  scene.poses = {Pose2(), Pose2(100.0, 0.0, 0.0)};
  const ClosureOutcome outcome = TestLast(scene, Pose2(-100.0, 0.0, 0.0), 1.65, true).outcome;
  EXPECT_TRUE(outcome == ClosureOutcome::kNoMatch || outcome == ClosureOutcome::kLowOverlap)
      << ToString(outcome);
}

TEST(LoopClosure, RejectsARoomThatLacksAWall) {
  // The same outer walls, but where one visit met a wall across the room the other looked through.
  SyntheticScene scene;
  scene.faces = Rectangle({-3.0, -2.5}, {3.0, 2.5});
  const std::vector<Face> other = Rectangle({97.0, -2.5}, {103.0, 2.5});
  scene.faces.insert(scene.faces.end(), other.begin(), other.end());
  scene.faces.push_back({{101.0, -2.5}, {101.0, 2.0}});
  scene.poses = {Pose2(), Pose2(100.0, 0.0, 0.0)};
  EXPECT_EQ(TestLast(scene, Pose2(-100.0, 0.0, 0.0), 0.5, false).outcome,
            ClosureOutcome::kFreeSpaceConflict);
}

TEST(LoopClosure, RejectsOneOfTwoTwinsInAWideWindow) {
  // The map shows equal bays of a comb, 2 m apart: a wide window cannot tell which is which.
  SyntheticScene scene;
  for (int i = -6; i <= 6; ++i) {
    scene.faces.push_back({{2.0 * i, 3.0}, {2.0 * i, 1.0}});
    scene.faces.push_back({{2.0 * i, 3.0}, {2.0 * i + 2.0, 3.0}});
  }
  scene.faces.push_back({{-30.0, -1.0}, {30.0, -1.0}});
  scene.laser.max_range_m = 4.0;
  scene.poses = {Pose2(-2.0, 0.0, 0.0), Pose2(2.0, 0.0, 0.0), Pose2(), Pose2(0.2, 0.0, 0.0)};
  EXPECT_EQ(TestLast(scene, Pose2(), 1.65, true).outcome, ClosureOutcome::kAmbiguous);
  EXPECT_EQ(TestLast(scene, Pose2(), 0.5, false).outcome, ClosureOutcome::kAccepted);
}

}  // namespace
}  // namespace plumbline
