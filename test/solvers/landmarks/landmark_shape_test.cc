#include "plumbline/solvers/landmarks/landmark_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr double kMarginRad = 0.17453292519943295;  // 10 degrees

LineLandmark LandmarkFacing(double degrees) {
  LineLandmark landmark;
  landmark.normal = {std::cos(DegToRad(degrees)), std::sin(DegToRad(degrees))};
  return landmark;
}

double ShapeCost(const LineLandmark& landmark, double degrees) {
  const Eigen::Vector2d normal = LandmarkFacing(degrees).normal;
  return 0.5 * normal.dot(landmark.ShapeTimes(normal));
}

// The terms between two landmarks that face these directions, seen together by some scans.
std::vector<LineLandmark> TermsBetween(double first_deg, double second_deg, int num_scans = 1) {
  std::vector<LineLandmark> landmarks = {LandmarkFacing(first_deg), LandmarkFacing(second_deg)};
  SetShapeTerms({{0, 1, num_scans}}, ShapeOptions(), kMarginRad, &landmarks);
  return landmarks;
}

TEST(LandmarkShapeTest, DrawsToTheNearestMultipleOfARightAngle) {
  for (const double category : {0.0, 90.0, 180.0, 270.0}) {
    const std::vector<LineLandmark> landmarks = TermsBetween(20.0, 20.0 + category + 4.0);
    // Cheapest where the two are exactly parallel or orthogonal, each given the other.
    EXPECT_NEAR(ShapeCost(landmarks[0], 24.0), 0.0, 1e-9) << category;
    EXPECT_NEAR(ShapeCost(landmarks[1], 20.0 + category), 0.0, 1e-9) << category;
    // And as it is: sine over sigma, squared, with the robust weight of that error.
    const double error = std::sin(DegToRad(4.0)) / ShapeOptions().sigma_rad;
    const double gate = ShapeOptions().robust_gate_sigmas;
    const double weight = std::pow(gate * gate / (gate * gate + error * error), 2);
    EXPECT_NEAR(ShapeCost(landmarks[0], 20.0), 0.5 * weight * error * error, 1e-9) << category;
  }
}

TEST(LandmarkShapeTest, LeavesSlantedSurfacesAlone) {
  for (const double angle : {11.0, 45.0, 79.0, 101.0}) {
    const std::vector<LineLandmark> landmarks = TermsBetween(0.0, angle);
    for (const LineLandmark& landmark : landmarks) {
      EXPECT_EQ(landmark.shape_xx, 0.0) << angle;
      EXPECT_EQ(landmark.shape_xy, 0.0) << angle;
      EXPECT_EQ(landmark.shape_yy, 0.0) << angle;
    }
  }
}

TEST(LandmarkShapeTest, CountsOncePerScanAndNotFromCallToCall) {
  std::vector<LineLandmark> landmarks = TermsBetween(0.0, 5.0, 3);
  const double three = ShapeCost(landmarks[0], 0.0);
  EXPECT_NEAR(three, 3.0 * ShapeCost(TermsBetween(0.0, 5.0)[0], 0.0), 1e-12);
  SetShapeTerms({{0, 1, 3}}, ShapeOptions(), kMarginRad, &landmarks);
  EXPECT_EQ(ShapeCost(landmarks[0], 0.0), three);
}

TEST(LandmarkShapeTest, FindsLandmarksThatFollowEachOtherAlongScans) {
  // One pose, one scan of a square room; landmarks by hand: quarters of the scan, the last returns
  // of each without one.
  SyntheticScene scene;
  scene.faces = {{{-2, -2}, {2, -2}}, {{2, -2}, {2, 2}}, {{2, 2}, {-2, 2}}, {{-2, 2}, {-2, -2}}};
  scene.laser = PanoramicLaser(360);
  scene.poses = {{0, 0, 0}, {0, 0, 0}};
  const SlamGraph graph = MakeGraph(scene);
  LineLandmarks landmarks;
  for (int scan = 0; scan < 2; ++scan) {
    for (int beam = 0; beam < 360; ++beam) {
      // 90 beams each; a hole of one beam between 0 and 1, of 30 beams between 2 and 3.
      const int landmark = beam / 90;
      const bool hole = beam == 90 || (landmark == 2 && beam >= 240);
      landmarks.landmark_of_return.push_back(hole ? LineLandmarks::kNone : landmark);
    }
  }
  landmarks.landmarks.resize(4);
  ThreadPool pool(1);
  const std::vector<AdjacentLandmarks> adjacent =
      FindAdjacentLandmarks(graph, SurfaceOf(graph), landmarks, 0.2, &pool);
  ASSERT_EQ(adjacent.size(), 2u);
  EXPECT_EQ(adjacent[0].first, 0);
  EXPECT_EQ(adjacent[0].second, 1);
  EXPECT_EQ(adjacent[0].num_scans, 2);
  EXPECT_EQ(adjacent[1].first, 1);
  EXPECT_EQ(adjacent[1].second, 2);
}

TEST(LandmarkShapeTest, AStrongTermTurnsTheLine) {
  // One observation of a stretch along x, and a neighbour that asks for a direction 5 degrees off.
  LineObservations observations;
  observations.observations.resize(1);
  observations.observations[0].weight = 100.0;
  observations.observations[0].xx = 10.0;
  observations.observations[0].yy = 0.01;
  observations.first_of_landmark = {0, 1};
  observations.of_pose = {0};
  observations.first_of_pose = {0, 1};
  ThreadPool pool(1);
  std::vector<LineLandmark> landmarks = {LandmarkFacing(90.0)};
  const std::vector<PoseFrame> frames(1);
  FitLandmarkLines(observations, frames, &pool, &landmarks);
  EXPECT_NEAR(std::abs(landmarks[0].normal.y()), 1.0, 1e-9);
  const Eigen::Vector2d tangent(std::cos(DegToRad(5.0)), std::sin(DegToRad(5.0)));
  landmarks[0].shape_xx = 1e6 * tangent.x() * tangent.x();
  landmarks[0].shape_xy = 1e6 * tangent.x() * tangent.y();
  landmarks[0].shape_yy = 1e6 * tangent.y() * tangent.y();
  const double cost = FitLandmarkLines(observations, frames, &pool, &landmarks);
  EXPECT_NEAR(landmarks[0].normal.dot(tangent), 0.0, 1e-4);
  // What it costs the observation to be seen aslant.
  EXPECT_NEAR(cost, 0.5 * 10.0 * std::pow(std::sin(DegToRad(5.0)), 2), 0.01);
}

}  // namespace
}  // namespace plumbline
