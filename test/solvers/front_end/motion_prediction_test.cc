#include "plumbline/solvers/front_end/motion_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace plumbline {
namespace {

SlamGraph GraphAt(const std::vector<double>& times_s) {
  SlamGraph graph;
  for (const double time_s : times_s) graph.AddPose(Pose2(), time_s);
  return graph;
}

// Poses along the x axis.
std::vector<Pose2> At(const std::vector<double>& x_m) {
  std::vector<Pose2> poses;
  for (const double x : x_m) poses.emplace_back(x, 0.0, 0.0);
  return poses;
}

TEST(MotionPrediction, TheRobotGoesOnAsBefore) {
  const MotionPrediction prediction(GraphAt({0.0, 0.2, 0.4, 0.6}));
  const Pose2 step(0.1, 0.01, 0.2);
  const std::vector<Pose2> poses = {Pose2(), step, step * step};
  const Pose2 predicted = prediction.Step(poses, 3);
  EXPECT_NEAR(predicted.x, 0.1, 1e-12);
  EXPECT_NEAR(predicted.y, 0.01, 1e-12);
  EXPECT_NEAR(predicted.yaw, 0.2, 1e-12);
}

TEST(MotionPrediction, TheFirstStepIsNone) {
  const MotionPrediction prediction(GraphAt({0.0, 0.2}));
  EXPECT_EQ(prediction.Step({Pose2(3.0, 2.0, 1.0)}, 1).x, 0.0);
}

TEST(MotionPrediction, ASingleOddStepChangesNothing) {
  const MotionPrediction prediction(GraphAt({0.0, 0.2, 0.4, 0.6, 0.8}));
  EXPECT_NEAR(prediction.Step(At({0.0, 0.1, 0.2, 0.7}), 4).x, 0.1, 1e-12);
}

TEST(MotionPrediction, WhereScansAreMissingItGoesOnForAsLong) {
  const MotionPrediction prediction(GraphAt({0.0, 0.2, 0.4, 1.0, 1.2, 1.4}));
  EXPECT_NEAR(prediction.period_s(), 0.2, 1e-12);
  EXPECT_NEAR(prediction.Step(At({0.0, 0.1, 0.2}), 3).x, 0.3, 1e-12);
  EXPECT_NEAR(prediction.Step(At({0.0, 0.1, 0.2, 0.5}), 4).x, 0.1, 1e-12);
}

TEST(MotionPrediction, AUselessClockGivesEachStepTheSameTime) {
  for (const std::vector<double>& times_s :
       {std::vector<double>(6, 0.0), std::vector<double>{0.0, 0.001, 0.4, 0.45, 1.1, 1.2}}) {
    const MotionPrediction prediction(GraphAt(times_s));
    EXPECT_EQ(prediction.period_s(), 0.0);
    EXPECT_NEAR(prediction.Step(At({0.0, 0.1, 0.2, 0.3, 0.4}), 5).x, 0.1, 1e-12);
  }
}

TEST(LacksOdometryTest, IsOnlySaidWhereSomethingCouldMove) {
  EXPECT_FALSE(LacksOdometry(GraphAt({0.0})));
  SlamGraph graph = GraphAt({0.0, 0.2});
  EXPECT_TRUE(LacksOdometry(graph));
  graph.AddOdometry({0, 1, Pose2()});
  EXPECT_FALSE(LacksOdometry(graph));
}

TEST(MeasurePredictionNoiseTest, IsTheRootMeanSquareOfWhatWasPredictedWrongly) {
  MotionOptions given;
  given.translation_floor_m = 1e-4;
  const SlamGraph graph = GraphAt({0.0, 0.2, 0.4});
  // Nothing is predicted for the first step, and 0.4 m for the second one.
  const OdometryNoiseReport noise = MeasurePredictionNoise(graph, At({0.0, 0.4, 0.7}), given);
  EXPECT_TRUE(noise.is_prediction);
  // Half of it along each axis.
  EXPECT_NEAR(noise.motion.translation_floor_m, std::sqrt((0.16 + 0.01) / 2.0 / 2.0), 1e-12);
  EXPECT_EQ(noise.motion.rotation_floor_rad, given.rotation_floor_rad);
}

TEST(AddPredictedStepsTest, JoinsEachPoseToTheNext) {
  SlamGraph graph = GraphAt({0.0, 0.2, 0.4});
  ASSERT_TRUE(AddPredictedSteps(At({0.0, 0.4, 0.7}), &graph).ok());
  ASSERT_EQ(graph.odometry().size(), 2u);
  EXPECT_EQ(graph.odometry()[0].from_from_to.x, 0.0);
  EXPECT_NEAR(graph.odometry()[1].from_from_to.x, 0.4, 1e-12);
  EXPECT_EQ(graph.odometry()[1].to, 2);
}

}  // namespace
}  // namespace plumbline
