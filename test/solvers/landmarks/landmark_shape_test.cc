#include "plumbline/solvers/landmarks/landmark_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr double kGateSigmas = 3.0;

LineLandmark LandmarkFacing(double degrees) {
  LineLandmark landmark;
  landmark.normal = {std::cos(DegToRad(degrees)), std::sin(DegToRad(degrees))};
  return landmark;
}

// What some poses, all of this heading, observed of two landmarks: nothing yet.
struct Observed {
  std::vector<PoseFrame> frames;
  std::vector<LineLandmark> landmarks;
  std::vector<AdjacentLandmarks> adjacent;
  LineObservations observations;

  Observed(double first_deg, double second_deg, int num_poses = 1, double heading_deg = 0.0)
      : frames(num_poses, PoseFrame(Pose2(1.0, 2.0, DegToRad(heading_deg)))),
        landmarks{LandmarkFacing(first_deg), LandmarkFacing(second_deg)} {
    observations.first_of_landmark = {0, frames.size(), 2 * frames.size()};
    observations.first_of_pose = {0};
    for (int landmark = 0; landmark < 2; ++landmark) {
      for (int pose = 0; pose < num_poses; ++pose) {
        observations.observations.push_back({pose, landmark});
      }
    }
    for (int pose = 0; pose < num_poses; ++pose) {
      adjacent.push_back({pose, 0, 1});
      observations.of_pose.insert(observations.of_pose.end(), {pose, pose + num_poses});
      observations.first_of_pose.push_back(observations.of_pose.size());
    }
  }

  Observed AddTerms() const {
    Observed with_terms = *this;
    AddShapeTerms(adjacent, kGateSigmas, landmarks, frames, &with_terms.observations);
    return with_terms;
  }

  // Of the terms on a landmark, if it faced this direction.
  double Cost(int landmark, double degrees) const {
    const Eigen::Vector2d normal = LandmarkFacing(degrees).normal;
    double cost = 0.0;
    for (const LineObservation& observation : observations.observations) {
      if (observation.landmark != landmark) continue;
      const Eigen::Vector2d in_robot = frames[observation.pose].RotateBack(normal);
      cost += 0.5 * in_robot.dot(observation.ScatterTimes(in_robot));
    }
    return cost;
  }
};

TEST(LandmarkShapeTest, DrawsToTheNearestMultipleOfARightAngle) {
  for (const double category : {0.0, 90.0, 180.0, 270.0}) {
    const Observed observed = Observed(20.0, 20.0 + category + 4.0, 1, 33.0).AddTerms();
    // Cheapest where the two are exactly parallel or orthogonal, midway.
    EXPECT_NEAR(observed.Cost(0, 22.0), 0.0, 1e-5) << category;
    EXPECT_NEAR(observed.Cost(1, 22.0 + category), 0.0, 1e-5) << category;
    // And as it is, both together: the distance of the normals over sigma, squared, with the robust
    // weight of that error.
    const double error = 2.0 * std::sin(DegToRad(2.0)) / kShapeSigmaRad;
    const double gate = kGateSigmas;
    const double weight = std::pow(gate * gate / (gate * gate + error * error), 2);
    EXPECT_NEAR(observed.Cost(0, 20.0) + observed.Cost(1, 24.0 + category),
                0.5 * weight * error * error, 1e-5)
        << category;
  }
}

TEST(LandmarkShapeTest, LeavesSlantedSurfacesAlone) {
  for (const double angle : {11.0, 45.0, 79.0, 101.0}) {
    const Observed observed = Observed(0.0, angle).AddTerms();
    for (const LineObservation& observation : observed.observations.observations) {
      EXPECT_EQ(observation.xx, 0.0) << angle;
      EXPECT_EQ(observation.xy, 0.0) << angle;
      EXPECT_EQ(observation.yy, 0.0) << angle;
    }
  }
}

TEST(LandmarkShapeTest, CountsOncePerScan) {
  const double one = Observed(0.0, 5.0).AddTerms().Cost(0, 0.0);
  EXPECT_GT(one, 0.1);
  EXPECT_NEAR(Observed(0.0, 5.0, 3).AddTerms().Cost(0, 0.0), 3.0 * one, 1e-12);
}

TEST(LandmarkShapeTest, WhatNoReturnPutsOnALandmarkIsNoTerm) {
  Observed observed(0.0, 5.0);
  observed.adjacent = {{0, 0, 2}};
  observed.landmarks.push_back(LandmarkFacing(3.0));
  EXPECT_EQ(observed.AddTerms().Cost(0, 0.0), 0.0);
}

// The energy is one of the map: poses and lines that turn together change nothing, and the pulls of
// a pair on the pose that saw it cancel.
TEST(LandmarkShapeTest, TurnsWithTheMap) {
  const double cost = Observed(20.0, 116.0).AddTerms().Cost(0, 20.0);
  EXPECT_GT(cost, 0.1);
  for (const double turn_deg : {1.0, 45.0, 170.0}) {
    const Observed turned = Observed(20.0 + turn_deg, 116.0 + turn_deg, 1, turn_deg).AddTerms();
    EXPECT_NEAR(turned.Cost(0, 20.0 + turn_deg), cost, 1e-9 * cost);
  }
  const Observed observed = Observed(20.0, 116.0).AddTerms();
  double pull = 0.0;
  for (int landmark = 0; landmark < 2; ++landmark) {
    const double facing = landmark == 0 ? 20.0 : 116.0, step = 1e-3;
    const double of_line =
        observed.Cost(landmark, facing + step) - observed.Cost(landmark, facing - step);
    EXPECT_GT(std::abs(of_line), 1e-5);
    pull -= of_line;
  }
  EXPECT_NEAR(pull, 0.0, 1e-9);
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
  const std::vector<AdjacentLandmarks> adjacent = FindAdjacentLandmarks(graph, landmarks, &pool);
  ASSERT_EQ(adjacent.size(), 4u);
  for (int pose = 0; pose < 2; ++pose) {
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(adjacent[2 * pose + i].pose, pose);
      EXPECT_EQ(adjacent[2 * pose + i].first, i);
      EXPECT_EQ(adjacent[2 * pose + i].second, i + 1);
    }
  }
}

// Two lines that two poses see 8 degrees apart, with a prior that is much stronger than what they
// see: both turn halfway, at once.
TEST(LandmarkShapeTest, ATermTurnsLinesThatAreHardlyObserved) {
  Observed observed(90.0, 98.0);
  for (LineObservation& observation : observed.observations.observations) {
    const double facing = DegToRad(observation.landmark == 0 ? 90.0 : 98.0);
    const Eigen::Vector2d along(-std::sin(facing), std::cos(facing));
    observation.weight = 100.0;
    observation.xx = static_cast<float>(1e-3 * along.x() * along.x());
    observation.xy = static_cast<float>(1e-3 * along.x() * along.y());
    observation.yy = static_cast<float>(1e-3 * along.y() * along.y());
  }
  constexpr double kNoGate = std::numeric_limits<double>::infinity();
  ThreadPool pool(1);
  const auto angle_between = [&] {
    return std::acos(std::abs(observed.landmarks[0].normal.dot(observed.landmarks[1].normal)));
  };
  for (int step = 0; step < 3; ++step) {
    LineObservations with_terms = observed.observations;
    AddShapeTerms(observed.adjacent, kNoGate, observed.landmarks, observed.frames, &with_terms);
    FitLandmarkLines(with_terms, observed.frames, &pool, &observed.landmarks);
    EXPECT_LT(angle_between(), DegToRad(0.01)) << step;
    EXPECT_NEAR(std::abs(observed.landmarks[0].normal.dot(LandmarkFacing(94.0).normal)), 1.0, 1e-6);
  }
}

}  // namespace
}  // namespace plumbline
