#include "plumbline/solvers/front_end/odometry_headings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

constexpr int kNumPoses = 600;
constexpr double kStepM = 0.25;

std::vector<Pose2> Chain(const std::vector<Pose2>& steps) {
  std::vector<Pose2> poses{Pose2(2.0, 3.0, 0.7)};
  for (const Pose2& step : steps) poses.push_back(poses.back() * step);
  return poses;
}

// Gently curved.
std::vector<Pose2> TrueSteps() {
  return std::vector<Pose2>(kNumPoses - 1, Pose2(kStepM, 0.0, 0.002));
}

double WorstM(const std::vector<Pose2>& a, const std::vector<Pose2>& b) {
  double worst_m = 0.0;
  for (std::size_t p = 0; p < a.size(); ++p) worst_m = std::max(worst_m, DistanceM(a[p], b[p]));
  return worst_m;
}

SequentialTrajectory Matched(const std::vector<Pose2>& steps) {
  SequentialTrajectory matched;
  matched.world_from_robot = Chain(steps);
  matched.odometry.resize(steps.size() + 1);
  return matched;
}

TEST(OdometryHeadings, TakeTheDriftOutOfAMatching) {
  const std::vector<Pose2> truth = Chain(TrueSteps());
  std::vector<Pose2> steps = TrueSteps();
  for (int p = 200; p < 500; ++p) steps[p].yaw += 0.001;  // 17 deg in all
  const SequentialTrajectory matched = Matched(steps);
  EXPECT_GT(WorstM(matched.world_from_robot, truth), 10.0);
  const SequentialTrajectory turned = WithOdometryHeadings(matched, truth, MotionOptions());
  // The mean is early at both ends of the drift, by the same.
  EXPECT_LT(WorstM(turned.world_from_robot, truth), 0.6);
  EXPECT_NEAR(turned.world_from_robot.back().yaw, truth.back().yaw, 0.005);
}

TEST(OdometryHeadings, KeepTheHeadingAtBothEndsOfTheDrive) {
  const std::vector<Pose2> truth = Chain(TrueSteps());
  std::vector<Pose2> steps = TrueSteps();
  for (int p = 0; p < 40; ++p) steps[p].yaw += 0.005;
  for (int p = 560; p < kNumPoses - 1; ++p) steps[p].yaw -= 0.005;
  const SequentialTrajectory turned = WithOdometryHeadings(Matched(steps), truth, MotionOptions());
  EXPECT_NEAR(turned.world_from_robot[300].yaw, truth[300].yaw, 1e-9);
  EXPECT_NEAR(turned.world_from_robot.back().yaw, truth.back().yaw, 1e-9);
}

TEST(OdometryHeadings, DoNotTurnARobotThatStands) {
  std::vector<Pose2> odometry = TrueSteps();
  std::vector<Pose2> steps = odometry;
  for (int p = 350; p < 400; ++p) steps[p].yaw += 0.005;  // after the stop, by 14 deg
  const std::vector<Pose2> stop(500, Pose2(0.0, 0.0, 0.0));
  odometry.insert(odometry.begin() + 300, stop.begin(), stop.end());
  steps.insert(steps.begin() + 300, stop.begin(), stop.end());
  const std::vector<Pose2> truth = Chain(odometry);
  const SequentialTrajectory turned = WithOdometryHeadings(Matched(steps), truth, MotionOptions());
  const std::vector<Pose2>& poses = turned.world_from_robot;
  EXPECT_NEAR(poses[300].yaw, poses[800].yaw, 1e-12);
  EXPECT_NEAR(poses.back().yaw, truth.back().yaw, 1e-9);
}

TEST(OdometryHeadings, LeaveSingleStepsAndLengthsToTheMatching) {
  const std::vector<Pose2> truth = Chain(TrueSteps());
  std::vector<Pose2> odometry = TrueSteps();
  for (std::size_t p = 0; p < odometry.size(); ++p) {
    odometry[p].x *= 1.1;
    odometry[p].yaw += p % 4 == 0 || p % 4 == 3 ? 0.02 : -0.02;
  }
  const SequentialTrajectory turned =
      WithOdometryHeadings(Matched(TrueSteps()), Chain(odometry), MotionOptions());
  EXPECT_LT(WorstM(turned.world_from_robot, truth), 0.2);
  for (int p = 1; p < kNumPoses; ++p) {
    EXPECT_NEAR(Between(turned.world_from_robot[p - 1], turned.world_from_robot[p]).yaw, 0.002,
                0.0008);
  }
}

TEST(OdometryHeadings, DoNotHearLeaps) {
  const std::vector<Pose2> truth = Chain(TrueSteps());
  std::vector<Pose2> odometry = TrueSteps();
  odometry[300].yaw += 1.5;  // the robot was turned
  MotionOptions wheels;
  wheels.rotation_per_rotation = 0.1;
  wheels.rotation_per_translation_rad_m = 0.02;
  const SequentialTrajectory turned =
      WithOdometryHeadings(Matched(TrueSteps()), Chain(odometry), wheels);
  EXPECT_LT(WorstM(turned.world_from_robot, truth), 1e-9);
}

TEST(OdometryHeadings, BearStepsFartherThanTheMeanReachesAndPosesAlone) {
  const std::vector<Pose2> steps(4, Pose2(50.0, 0.0, 0.01));
  std::vector<Pose2> odometry = steps;
  for (Pose2& step : odometry) step.yaw += 0.01;
  const SequentialTrajectory turned =
      WithOdometryHeadings(Matched(steps), Chain(odometry), MotionOptions());
  EXPECT_NEAR(turned.world_from_robot.back().yaw, Chain(odometry).back().yaw, 1e-12);
  const SequentialTrajectory alone = Matched({});
  EXPECT_EQ(
      WithOdometryHeadings(alone, alone.world_from_robot, MotionOptions()).world_from_robot.size(),
      1u);
}

}  // namespace
}  // namespace plumbline
