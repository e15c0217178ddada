#include <gtest/gtest.h>

#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

constexpr int kNumSteps = 100;
constexpr int kStepsPerKey = 5;

// What a match knows in an ordinary room, and along a bare corridor. Axes of the robot.
const Eigen::Vector3d kRoom(1e5, 1e5, 1e6);
const Eigen::Vector3d kCorridor(0.0, 1e5, 1e6);

// Straight ahead from (2, 3) along y, every step matched where the odometry put it.
SequentialTrajectory Drive(double step_m, const Eigen::Vector3d& information) {
  SequentialTrajectory trajectory;
  trajectory.world_from_robot.emplace_back(2.0, 3.0, 0.5 * kPi);
  trajectory.odometry.emplace_back();
  for (int pose = 0; pose <= kNumSteps; ++pose) {
    if (pose > 0) {
      trajectory.odometry.emplace_back(step_m, 0.0, 0.0);
      trajectory.world_from_robot.push_back(trajectory.world_from_robot.back() *
                                            trajectory.odometry.back());
    }
    if (pose % kStepsPerKey != 0) continue;
    Keyframe key;
    key.pose = key.scan = pose;
    key.information = information.asDiagonal();
    trajectory.keyframes.push_back(key);
  }
  return trajectory;
}

OdometryNoiseReport ReadsAQuarterTooMuch() {
  OdometryNoiseReport report;
  report.translation_scale = {0.25, 0.01};
  return report;
}

std::vector<Pose2> Corrected(const SequentialTrajectory& trajectory,
                             const OdometryNoiseReport& report) {
  std::vector<Pose2> steps;
  for (const Pose2& step : trajectory.odometry) steps.push_back(CorrectStep(step, report));
  return steps;
}

TEST(CorrectOdometry, MendsACorridorThatTheOdometryStretched) {
  SequentialTrajectory trajectory = Drive(0.125, kCorridor);
  CorrectOdometry(Corrected(trajectory, ReadsAQuarterTooMuch()), MotionOptions(), &trajectory);
  ASSERT_EQ(trajectory.world_from_robot.size(), kNumSteps + 1u);
  for (int pose = 0; pose <= kNumSteps; ++pose) {
    EXPECT_LT(DistanceM(trajectory.world_from_robot[pose], {2.0, 3.0 + 0.1 * pose, 0.0}), 1e-9);
    EXPECT_NEAR(trajectory.world_from_robot[pose].yaw, 0.5 * kPi, 1e-12);
  }
  EXPECT_NEAR(trajectory.odometry[1].x, 0.1, 1e-12);
  EXPECT_NEAR(trajectory.odometry[kNumSteps].x, 0.1, 1e-12);
}

TEST(CorrectOdometry, LeavesWhatTheMatchesKnow) {
  const SequentialTrajectory before = Drive(0.125, kRoom);
  SequentialTrajectory trajectory = before;
  CorrectOdometry(Corrected(trajectory, ReadsAQuarterTooMuch()), MotionOptions(), &trajectory);
  for (int pose = 0; pose <= kNumSteps; ++pose) {
    EXPECT_LT(DistanceM(trajectory.world_from_robot[pose], before.world_from_robot[pose]), 1e-3);
  }
  EXPECT_NEAR(trajectory.odometry.back().x, 0.1, 1e-12);
}

TEST(CorrectOdometry, AnErrorThatMayBeChanceMovesNothing) {
  const SequentialTrajectory before = Drive(0.125, kCorridor);
  SequentialTrajectory trajectory = before;
  OdometryNoiseReport report;
  report.translation_scale = {0.25, 0.1};
  CorrectOdometry(Corrected(trajectory, report), MotionOptions(), &trajectory);
  for (int pose = 0; pose <= kNumSteps; ++pose) {
    EXPECT_LT(DistanceM(trajectory.world_from_robot[pose], before.world_from_robot[pose]), 1e-12);
    EXPECT_EQ(trajectory.odometry[pose].x, before.odometry[pose].x);
  }
}

TEST(CorrectOdometry, TurnsACorridorThatTheOdometryBent) {
  // 0.01 rad per metre too much to the left, where the scans say nothing at all.
  SequentialTrajectory trajectory = Drive(0.1, Eigen::Vector3d::Zero());
  OdometryNoiseReport report;
  report.heading_drift_rad_m = {0.01, 0.001};
  CorrectOdometry(Corrected(trajectory, report), MotionOptions(), &trajectory);
  // An arc of 10 m to the right, 0.1 rad long: its end lies 10 m 0.1 / 2 to the right.
  EXPECT_NEAR(trajectory.world_from_robot.back().yaw, 0.5 * kPi - 0.1, 1e-6);
  EXPECT_NEAR(trajectory.world_from_robot.back().x, 2.0 + 0.5, 1e-3);
  EXPECT_NEAR(trajectory.world_from_robot.back().y, 3.0 + 10.0 - 10.0 * 0.01 / 6.0, 1e-3);
}

}  // namespace
}  // namespace plumbline
