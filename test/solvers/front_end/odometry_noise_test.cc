#include "plumbline/solvers/front_end/odometry_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr double kStepM = 0.1;
constexpr int kStepsPerKey = 2;
constexpr int kNumSteps = 6000;  // 150 times 3 m straight ahead and a curve of 2 rad: 525 m

// What a match knows in an ordinary room, and along a bare corridor.
const Eigen::Vector3d kRoom(1e5, 1e5, 1e6);
const Eigen::Vector3d kCorridor(10.0, 1e5, 1e6);

// Straight ahead, then round a curve; left and right in turn.
Pose2 TrueStep(int i) {
  const int phase = i % 80;
  if (phase % 40 < 30) return {kStepM, 0.0, 0.0};
  const double turn = phase < 40 ? 0.2 : -0.2;
  const Pose2 half(0.0, 0.0, 0.5 * turn);
  return half * Pose2(0.5 * kStepM, 0.0, 0.0) * half;
}

// What the odometry reads, step by step, of a drive that is matched without error.
SequentialTrajectory Drive(int num_steps, const std::function<Pose2(int, const Pose2&)>& odometry,
                           const Eigen::Vector3d& information = kRoom) {
  SequentialTrajectory trajectory;
  for (int pose = 0; pose <= num_steps; ++pose) {
    if (pose == 0) {
      trajectory.world_from_robot.emplace_back();
      trajectory.odometry.emplace_back();
    } else {
      const Pose2 step = TrueStep(pose - 1);
      trajectory.world_from_robot.push_back(trajectory.world_from_robot.back() * step);
      trajectory.odometry.push_back(odometry(pose, step));
    }
    if (pose % kStepsPerKey != 0) continue;
    Keyframe key;
    key.pose = key.scan = pose;
    key.information = information.asDiagonal();
    trajectory.keyframes.push_back(key);
  }
  return trajectory;
}

// Thrun's odometry, with systematic errors: turn, drive, turn.
struct Wheels {
  MotionOptions noise{0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  double translation_scale = 0.0;
  double rotation_scale = 0.0;
  double heading_drift_rad_m = 0.0;
  NoiseSource source{1, 0};

  Pose2 operator()(int, const Pose2& step) {
    const double trans = std::hypot(step.x, step.y), rot1 = std::atan2(step.y, step.x);
    const double excess = heading_drift_rad_m * trans;
    return Turn(rot1, trans, excess) * Straight(trans, step.yaw) *
           Turn(step.yaw - rot1, trans, excess);
  }

 private:
  Pose2 Turn(double angle, double trans, double excess) {
    const double sigma = noise.rotation_per_rotation * std::abs(angle) +
                         noise.rotation_per_translation_rad_m * trans;
    return {0.0, 0.0, (1.0 + rotation_scale) * angle + 0.5 * excess + sigma * source.Gaussian()};
  }
  Pose2 Straight(double trans, double turn) {
    const double sigma = noise.translation_per_translation * trans +
                         noise.translation_per_rotation_m_rad * std::abs(turn);
    return {(1.0 + translation_scale) * trans + sigma * source.Gaussian(), 0.0, 0.0};
  }
};

Wheels NoisyWheels() {
  Wheels wheels;
  wheels.noise.translation_per_translation = 0.1;
  wheels.noise.rotation_per_translation_rad_m = 0.1;
  wheels.noise.rotation_per_rotation = 0.1;
  return wheels;
}

TEST(OdometryNoise, RecoversWhatTheWheelsGotWrong) {
  Wheels wheels = NoisyWheels();
  wheels.translation_scale = 0.05;
  wheels.rotation_scale = -0.04;
  wheels.heading_drift_rad_m = 0.02;
  const OdometryNoiseReport report =
      EstimateOdometryNoise(Drive(kNumSteps, wheels), MotionOptions());
  EXPECT_NEAR(report.translation_scale.value, 0.05, 4.0 * report.translation_scale.sigma);
  EXPECT_NEAR(report.rotation_scale.value, -0.04, 4.0 * report.rotation_scale.sigma);
  EXPECT_NEAR(report.heading_drift_rad_m.value, 0.02, 4.0 * report.heading_drift_rad_m.sigma);
  // Independent errors of 0.1 sqrt(0.1 m) per sqrt(m) fix the scale over 525 m to 0.0014; the drift
  // has twice that variance, and 300 rad fix the scale of turns to 0.002.
  EXPECT_LT(report.translation_scale.sigma, 0.002);
  EXPECT_LT(report.rotation_scale.sigma, 0.004);
  EXPECT_LT(report.heading_drift_rad_m.sigma, 0.004);
  EXPECT_TRUE(report.translation_scale.IsSignificant());
  EXPECT_TRUE(report.rotation_scale.IsSignificant());
  EXPECT_TRUE(report.heading_drift_rad_m.IsSignificant());
  EXPECT_EQ(report.num_leaps, 0);
  const Pose2 step = TrueStep(32);
  const Pose2 read(1.05 * step.x, 1.05 * step.y, 0.96 * step.yaw + 0.02 * 0.5 * kStepM);
  EXPECT_NEAR(CorrectStep(read, report).x, step.x, 3e-4);
  EXPECT_NEAR(CorrectStep(read, report).yaw, step.yaw, 2e-3);
}

TEST(OdometryNoise, RecoversTheAlphas) {
  const OdometryNoiseReport report =
      EstimateOdometryNoise(Drive(kNumSteps, NoisyWheels()), MotionOptions());
  EXPECT_NEAR(report.motion.translation_per_translation, 0.1, 0.02);
  EXPECT_NEAR(report.motion.rotation_per_translation_rad_m, 0.1, 0.02);
  EXPECT_NEAR(report.motion.rotation_per_rotation, 0.1, 0.03);
  EXPECT_FALSE(report.translation_scale.IsSignificant());
  EXPECT_FALSE(report.rotation_scale.IsSignificant());
  EXPECT_FALSE(report.heading_drift_rad_m.IsSignificant());
  const Pose2 step(0.1, 0.01, 0.2), corrected = CorrectStep(step, report);
  EXPECT_EQ(corrected.x, step.x);
  EXPECT_EQ(corrected.y, step.y);
  EXPECT_EQ(corrected.yaw, step.yaw);
}

TEST(OdometryNoise, ReproducesTheGrowthOfVarianceWithEqualSteps) {
  NoiseSource source(2, 0);
  SequentialTrajectory trajectory = Drive(2400, [](int, const Pose2&) { return Pose2(); });
  for (int pose = 1; pose <= 2400; ++pose) {
    trajectory.world_from_robot[pose] = {kStepM * pose, 0.0, 0.0};
    trajectory.odometry[pose] = {kStepM + 0.01 * source.Gaussian(), 0.0, 0.0};
  }
  const MotionOptions given;
  const OdometryNoiseReport report = EstimateOdometryNoise(trajectory, given);
  // Ten steps of 0.01 m per metre: 0.0316 m after one. That many spans know it to 5 %.
  EXPECT_GE(report.translation.num_spans, 200);  // of 1 m, or of 1.2 m if rounding says so
  EXPECT_NEAR(report.translation.sigma_per_sqrt_m, 0.01 * std::sqrt(10.0), 0.004);
  EXPECT_NEAR(report.motion.translation_per_translation,
              report.translation.sigma_per_sqrt_m / std::sqrt(kStepM), 2e-3);
  // The robot never turned, so nothing is known of turns.
  EXPECT_EQ(report.motion.translation_per_rotation_m_rad, given.translation_per_rotation_m_rad);
  EXPECT_EQ(report.motion.rotation_per_rotation, given.rotation_per_rotation);
  EXPECT_EQ(report.motion.translation_floor_m, given.translation_floor_m);
}

TEST(OdometryNoise, SaysNothingOfTheDirectionOfABareCorridor) {
  // The match follows the odometry, so that the two agree to the last digit.
  const auto follows = [](int, const Pose2& step) { return step; };
  const MotionOptions given;
  const OdometryNoiseReport report =
      EstimateOdometryNoise(Drive(kNumSteps, follows, kCorridor), given);
  EXPECT_FALSE(report.translation.estimated);
  EXPECT_EQ(report.translation.num_spans, 0);
  EXPECT_EQ(report.motion.translation_per_translation, given.translation_per_translation);
  EXPECT_EQ(report.motion.translation_per_rotation_m_rad, given.translation_per_rotation_m_rad);
  EXPECT_TRUE(report.rotation.estimated);
  EXPECT_LT(report.motion.rotation_per_translation_rad_m, 1e-3);
}

TEST(OdometryNoise, SlipsEnlargeTheSigmasButDoNotRuleThem) {
  Wheels honest = NoisyWheels(), slipping = NoisyWheels();
  const auto slips = [&](int pose, const Pose2& step) {
    const Pose2 read = slipping(pose, step);
    return pose % 300 == 0 ? read * Pose2(0.15, 0.0, 0.0) : read;
  };
  const double calm =
      EstimateOdometryNoise(Drive(kNumSteps, honest), MotionOptions()).translation.sigma_per_sqrt_m;
  const OdometryNoiseReport report =
      EstimateOdometryNoise(Drive(kNumSteps, slips), MotionOptions());
  EXPECT_GT(report.translation.sigma_per_sqrt_m, 1.08 * calm);
  // Not gated, 20 slips of 0.15 m within 525 m would add 0.15^2 x 20 / 525 to the calm 0.03^2:
  // a factor of 1.4 on the sigma.
  EXPECT_LT(report.translation.sigma_per_sqrt_m, 1.25 * calm);
}

TEST(OdometryNoise, CountsLeaps) {
  const auto leaps = [](int pose, const Pose2& step) {
    if (pose == 1001) return step * Pose2(0.0, 0.5, 0.0);
    if (pose == 3001) return step * Pose2(0.0, 0.0, 0.6);
    return step;
  };
  EXPECT_EQ(EstimateOdometryNoise(Drive(kNumSteps, leaps), MotionOptions()).num_leaps, 2);
}

TEST(OdometryNoise, DoesNotScaleAnOdometryThatMeasuresNothing) {
  const auto dead = [](int, const Pose2&) { return Pose2(); };
  const OdometryNoiseReport report = EstimateOdometryNoise(Drive(kNumSteps, dead), MotionOptions());
  EXPECT_NEAR(report.translation_scale.value, -1.0, 0.01);
  EXPECT_FALSE(report.translation_scale.IsSignificant());
  EXPECT_EQ(CorrectStep({0.1, 0.0, 0.0}, report).x, 0.1);
}

TEST(OdometryNoise, KeepsTheGivenNoiseOnAShortLog) {
  MotionOptions given;
  given.rotation_per_rotation = 0.123;
  const OdometryNoiseReport report = EstimateOdometryNoise(Drive(200, NoisyWheels()), given);
  EXPECT_FALSE(report.translation.estimated);
  EXPECT_FALSE(report.rotation.estimated);
  EXPECT_GT(report.rotation.num_spans, 0);
  EXPECT_EQ(report.motion.rotation_per_rotation, 0.123);
  EXPECT_EQ(report.motion.translation_per_translation, given.translation_per_translation);
  EXPECT_FALSE(report.translation_scale.IsSignificant());
  EXPECT_EQ(EstimateOdometryNoise(SequentialTrajectory(), given).num_leaps, 0);
}

TEST(OdometryNoise, RefinesWithWhatTheScansSayOfForwardMotionOnly) {
  MotionOptions given;
  OdometryNoiseReport report;
  report.motion.translation_per_translation = 0.02;
  report.motion.rotation_per_translation_rad_m = 0.01;
  MotionOptions motion = RefinementMotion(report, given);
  EXPECT_EQ(motion.translation_per_translation, given.translation_per_translation);
  EXPECT_EQ(motion.translation_floor_m, given.translation_floor_m);
  report.translation.estimated = report.rotation.estimated = true;
  motion = RefinementMotion(report, given);
  EXPECT_EQ(motion.translation_per_translation, 0.02);
  EXPECT_EQ(motion.translation_floor_m, 0.005);
  EXPECT_EQ(motion.rotation_per_translation_rad_m, given.rotation_per_translation_rad_m);
  given.translation_floor_m = 1e-4;
  EXPECT_EQ(RefinementMotion(report, given).translation_floor_m, 1e-4);
  given.translation_per_translation = 0.015;  // never more than given
  EXPECT_EQ(RefinementMotion(report, given).translation_per_translation, 0.015);
}

TEST(OdometryNoise, CorrectsAStepByHand) {
  OdometryNoiseReport report;
  report.translation_scale = {0.25, 0.01};
  report.heading_drift_rad_m = {0.1, 0.01};
  report.rotation_scale = {0.4, 0.2};  // not significant
  // One metre straight ahead: half of the drift before it, half behind it.
  const Pose2 read(1.25 * std::cos(0.05), 1.25 * std::sin(0.05), 0.1);
  const Pose2 corrected = CorrectStep(read, report);
  EXPECT_NEAR(corrected.x, 1.0, 2e-3);
  EXPECT_NEAR(corrected.y, 0.0, 2e-3);
  EXPECT_NEAR(corrected.yaw, 0.0, 2e-3);
  report.heading_drift_rad_m = {};
  report.rotation_scale = {0.2, 0.01};
  EXPECT_NEAR(CorrectStep({0.0, 0.0, 0.3}, report).yaw, 0.25, 1e-12);
  EXPECT_NEAR(CorrectStep({-1.25, 0.0, 0.0}, report).x, -1.0, 1e-12);
}

}  // namespace
}  // namespace plumbline
