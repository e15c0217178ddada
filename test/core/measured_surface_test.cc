#include "plumbline/core/measured_surface.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/core/initial_guesses.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

/// A room with more scans than one thread takes at a time, by a laser off the robot's centre.
SlamGraph MountedLaserRoom() {
  SyntheticScene scene;
  scene.faces = {{{3, -2}, {3, 2}}, {{3, 2}, {-3, 2}}, {{-3, 2}, {-3, -2}}, {{-3, -2}, {3, -2}}};
  scene.laser = PanoramicLaser(90);
  scene.laser.robot_from_laser = {0.4, -0.2, 2.0};
  scene.range_sigma_m = 0.01;
  RandomStates random(1);
  for (int i = 0; i < 130; ++i) {
    scene.poses.push_back(
        {random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-kPi, kPi)});
  }
  return MakeGraph(scene);
}

TEST(MeasuredSurfaceTest, HoldsEveryReturnInTheFrameOfItsRobot) {
  const SlamGraph graph = MountedLaserRoom();
  ThreadPool pool(2);
  const ReturnNormalOptions options;
  const MeasuredSurface surface = MeasureSurface(graph, options, &pool);
  ASSERT_EQ(surface.points.size(), graph.num_returns());
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    const Eigen::Vector2d expected = graph.PointInRobot(r);
    EXPECT_LT((surface.points[r].cast<double>() - expected).norm(), 1e-6) << r;
  }
  EXPECT_EQ(surface.normals, EstimateReturnNormals(graph, options, &pool));
}

TEST(MeasuredSurfaceTest, DoesNotLookAtInitialGuesses) {
  const SlamGraph graph = MountedLaserRoom();
  ThreadPool pool(1);
  std::vector<double> guesses = graph.initial_poses();
  for (double& coordinate : guesses) coordinate += 0.7;
  const SlamGraph other = WithInitialPoses(graph, PosesOf(guesses));
  const MeasuredSurface one = MeasureSurface(graph, ReturnNormalOptions(), &pool);
  const MeasuredSurface two = MeasureSurface(other, ReturnNormalOptions(), &pool);
  EXPECT_EQ(two.points, one.points);
  EXPECT_EQ(two.normals, one.normals);
}

TEST(MeasuredSurfaceTest, TakesNormalsThatAreKnown) {
  const SlamGraph graph = MountedLaserRoom();
  std::vector<Eigen::Vector2f> normals(graph.num_returns());
  for (std::size_t r = 0; r < normals.size(); ++r) normals[r] = {0.6f, r % 2 == 0 ? 0.8f : -0.8f};
  for (const int num_threads : {1, 2, 5}) {
    ThreadPool pool(num_threads);
    const MeasuredSurface surface = MeasureSurface(graph, normals, &pool);
    EXPECT_EQ(surface.normals, normals);
    EXPECT_EQ(surface.points, MeasureSurface(graph, ReturnNormalOptions(), &pool).points);
  }
}

TEST(MeasuredSurfaceTest, IsEmptyWithoutReturns) {
  SlamGraph graph;
  ThreadPool pool(2);
  int pose = 0, laser = 0;
  ASSERT_TRUE(graph.AddPose({1, 2, 3}, 0.0, &pose).ok());
  EXPECT_TRUE(MeasureSurface(graph, ReturnNormalOptions(), &pool).points.empty());
  ASSERT_TRUE(graph.AddLaser(PanoramicLaser(2), &laser).ok());
  ASSERT_TRUE(graph.AddScan(pose, laser, {kNaN, kInfinity}).ok());
  const MeasuredSurface surface = MeasureSurface(graph, ReturnNormalOptions(), &pool);
  EXPECT_TRUE(surface.points.empty());
  EXPECT_TRUE(surface.normals.empty());
}

}  // namespace
}  // namespace plumbline
