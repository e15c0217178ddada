#include "plumbline/core/measured_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
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

TEST(MeasuredSurfaceTest, IsTheSameOnAnyNumberOfThreads) {
  const SlamGraph graph = MountedLaserRoom();
  const ReturnNormalOptions options;
  ThreadPool one(1);
  const MeasuredSurface expected = MeasureSurface(graph, options, &one);
  ASSERT_EQ(expected.normals.size(), graph.num_returns());
  const auto is_none = [](const ReturnNormal& normal) { return normal.IsNone(); };
  EXPECT_LT(std::count_if(expected.normals.begin(), expected.normals.end(), is_none),
            static_cast<std::ptrdiff_t>(graph.num_returns()) - 1000);
  for (const int num_threads : {2, 5}) {
    ThreadPool pool(num_threads);
    EXPECT_EQ(MeasureSurface(graph, options, &pool).normals, expected.normals);
  }
}

TEST(MeasuredSurfaceTest, ExtendedItIsTheSame) {
  const SlamGraph graph = MountedLaserRoom();
  ThreadPool pool(2);
  const MeasuredSurface expected = MeasureSurface(graph, ReturnNormalOptions(), &pool);
  MeasuredSurface surface;
  surface.normals.assign(expected.normals.begin(),
                         expected.normals.begin() + graph.scan(100).first_return);
  ExtendSurface(graph, 100, ReturnNormalOptions(), &pool, &surface);
  EXPECT_EQ(surface.normals, expected.normals);
}

TEST(MeasuredSurfaceTest, DoesNotLookAtInitialGuesses) {
  const SlamGraph graph = MountedLaserRoom();
  ThreadPool pool(1);
  std::vector<double> guesses = graph.initial_poses();
  for (double& coordinate : guesses) coordinate += 0.7;
  const SlamGraph other = WithInitialPoses(graph, PosesOf(guesses));
  const MeasuredSurface one = MeasureSurface(graph, ReturnNormalOptions(), &pool);
  const MeasuredSurface two = MeasureSurface(other, ReturnNormalOptions(), &pool);
  EXPECT_EQ(two.normals, one.normals);
}

TEST(MeasuredSurfaceTest, IsEmptyWithoutReturns) {
  SlamGraph graph;
  ThreadPool pool(2);
  const int pose = graph.AddPose({1, 2, 3}, 0.0);
  EXPECT_TRUE(MeasureSurface(graph, ReturnNormalOptions(), &pool).normals.empty());
  const int laser = graph.AddLaser(PanoramicLaser(2));
  graph.AddScan(pose, laser, {kNaN, kInfinity});
  const MeasuredSurface surface = MeasureSurface(graph, ReturnNormalOptions(), &pool);
  EXPECT_TRUE(surface.normals.empty());
}

}  // namespace
}  // namespace plumbline
