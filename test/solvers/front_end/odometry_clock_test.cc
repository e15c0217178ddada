#include "plumbline/solvers/front_end/odometry_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr double kPeriodS = 0.2;
constexpr int kNumPoses = 1000;

// Turns left and right at up to 0.6 rad/s, in waves that never repeat.
double Winding(double time_s) {
  return 0.4 * std::sin(0.9 * time_s) + 0.2 * std::sin(1.7 * time_s + 1.0);
}
double Straight(double) { return 0.0; }
double Circle(double) { return 0.3; }
// A left turn of 90 degrees every 20 s.
double Corridors(double time_s) {
  const double phase_s = time_s - 20.0 * std::floor(time_s / 20.0);
  return phase_s < 2.0 ? 0.5 * kPi * std::pow(std::sin(0.5 * kPi * phase_s), 2) : 0.0;
}

// A robot at 0.5 m/s from 2 s before the first scan to 2 s after the last one.
class Drive {
 public:
  explicit Drive(const std::function<double(double)>& turn_rate) {
    Pose2 pose;
    for (double time_s = -2.0; time_s < kPeriodS * kNumPoses + 2.0; time_s += kTickS) {
      poses_.push_back(pose);
      pose = pose * Pose2(0.5 * kTickS, 0.0, turn_rate(time_s) * kTickS);
    }
  }
  Pose2 At(double time_s) const { return poses_[std::lround((time_s + 2.0) / kTickS)]; }

 private:
  static constexpr double kTickS = 0.001;
  std::vector<Pose2> poses_;
};

struct Recording {
  SlamGraph graph;
  SequentialTrajectory trajectory;
};

// The odometry that comes with a scan tells where the robot was `offset_s` after it. noise_rad: of
// its turns; of_matches_rad: of every matched heading.
Recording Record(const Drive& drive, double offset_s, double noise_rad = 0.0,
                 double period_s = kPeriodS, double of_matches_rad = 0.0) {
  Recording recording;
  NoiseSource noise(1, 0);
  for (int i = 0; i < kNumPoses; ++i) {
    const double time_s = kPeriodS * i;
    recording.graph.AddPose(drive.At(time_s), period_s * i);
    recording.trajectory.world_from_robot.push_back(
        drive.At(time_s) * Pose2(0.0, 0.0, of_matches_rad * noise.Gaussian()));
    const double before_s = std::max(0.0, time_s - kPeriodS);
    Pose2 step = Between(drive.At(before_s + offset_s), drive.At(time_s + offset_s));
    step.yaw += noise_rad * noise.Gaussian();
    recording.trajectory.odometry.push_back(step);
  }
  return recording;
}

TEST(OdometryClock, OffsetsOfPartsOfAStepAndOfSeveralAreFound) {
  for (const double offset_s : {0.13, -0.07, 0.63, -0.9}) {
    const Recording recording = Record(Drive(Winding), offset_s, 0.002);
    const ClockOffset found = EstimateClockOffset(recording.graph, recording.trajectory);
    EXPECT_TRUE(found.IsSignificant()) << offset_s;
    EXPECT_NEAR(found.value_s, offset_s, 5.0 * found.sigma_s) << offset_s;
    EXPECT_LT(found.sigma_s, 0.005) << offset_s;
  }
}

TEST(OdometryClock, ConstantErrorsOfTheOdometryAreNoOffset) {
  Recording recording = Record(Drive(Winding), 0.0, 0.002);
  for (Pose2& step : recording.trajectory.odometry) step.yaw += 0.1 * step.yaw + 0.05 * step.x;
  EXPECT_FALSE(EstimateClockOffset(recording.graph, recording.trajectory).IsSignificant());
}

// Interpolation averages noise, most of it half-way between scans.
TEST(OdometryClock, NoiseOfMatchesIsNoOffset) {
  for (const double noise_rad : {0.0003, 0.002}) {
    for (const double of_matches_rad : {0.0005, 0.001, 0.002, 0.004}) {
      const Recording recording =
          Record(Drive(Corridors), 0.0, noise_rad, kPeriodS, of_matches_rad);
      EXPECT_FALSE(EstimateClockOffset(recording.graph, recording.trajectory).IsSignificant())
          << noise_rad << ' ' << of_matches_rad;
    }
  }
  const Recording late = Record(Drive(Corridors), -0.15, 0.001, kPeriodS, 0.001);
  const ClockOffset found = EstimateClockOffset(late.graph, late.trajectory);
  EXPECT_TRUE(found.IsSignificant());
  EXPECT_NEAR(found.value_s, -0.15, 0.02);
}

TEST(OdometryClock, WhatTurnsDoNotTellIsUnknown) {
  const auto sigma_s = [](const Recording& recording) {
    return EstimateClockOffset(recording.graph, recording.trajectory).sigma_s;
  };
  EXPECT_EQ(sigma_s(Record(Drive(Straight), 0.3, 0.002, kPeriodS, 0.001)), 0.0);
  EXPECT_EQ(sigma_s(Record(Drive(Circle), 0.3, 0.002, kPeriodS, 0.001)), 0.0);
  EXPECT_EQ(sigma_s(Record(Drive(Winding), 1.3, 0.002)), 0.0);        // too far
  EXPECT_EQ(sigma_s(Record(Drive(Winding), 0.3, 0.002, 0.0)), 0.0);   // no clock
  EXPECT_EQ(sigma_s(Record(Drive(Winding), 0.3, 0.002, -0.2)), 0.0);  // it falls
  EXPECT_EQ(sigma_s({}), 0.0);
  EXPECT_EQ(OdometryInTime(SlamGraph(), {}, 0.3).size(), 0u);
}

TEST(OdometryClock, StampsOfWholeSecondsAreUnknown) {
  Recording rounded;
  const Recording recording = Record(Drive(Winding), 0.0, 0.002);
  rounded.trajectory = recording.trajectory;
  for (int i = 0; i < kNumPoses; ++i) {
    rounded.graph.AddPose({}, std::floor(kPeriodS * i));
  }
  EXPECT_EQ(EstimateClockOffset(rounded.graph, rounded.trajectory).sigma_s, 0.0);
}

TEST(OdometryClock, StepsBesideAGapStayAsTheyAre) {
  SlamGraph graph;
  std::vector<Pose2> odometry;
  for (const double time_s : {0.0, 0.2, 0.4, 60.0, 60.2, 60.4, 60.6}) {
    graph.AddPose({}, time_s);
    odometry.emplace_back(time_s == 60.0 ? 10.0 : 0.0, 0.0, 0.0);
  }
  const std::vector<Pose2> steps = OdometryInTime(graph, odometry, 0.3);
  for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_EQ(steps[i].x, odometry[i].x) << i;
}

TEST(OdometryClock, StampsThatNearlyCoincideDoNoHarm) {
  // Every second scan comes a microsecond after the one before, the last one too.
  Recording recording;
  const Drive drive(Winding);
  for (int i = 0; i < kNumPoses; ++i) {
    const int pair = i / 2, pair_before = (i - 1) / 2;
    const double time_s = kPeriodS * 2 * pair + 1e-6 * (i % 2);
    recording.graph.AddPose(drive.At(time_s), time_s);
    recording.trajectory.world_from_robot.push_back(drive.At(time_s) *
                                                    Pose2(0.0, 0.0, i % 2 == 0 ? 0.001 : -0.001));
    const double before_s = kPeriodS * 2 * pair_before;
    recording.trajectory.odometry.push_back(
        Between(drive.At(before_s + 0.13), drive.At(time_s + 0.13)));
  }
  const ClockOffset found = EstimateClockOffset(recording.graph, recording.trajectory);
  EXPECT_NEAR(found.value_s, 0.13, 0.02);
  for (const Pose2& step : OdometryInTime(recording.graph, recording.trajectory.odometry, 0.13)) {
    EXPECT_LT(std::hypot(step.x, step.y), 0.3);
  }
}

TEST(OdometryClock, StepsInTimeAreThoseOfTheRobot) {
  constexpr double kOffsetS = 0.13;
  const Recording recording = Record(Drive(Winding), kOffsetS);
  const std::vector<Pose2> steps =
      OdometryInTime(recording.graph, recording.trajectory.odometry, kOffsetS);
  ASSERT_EQ(steps.size(), static_cast<std::size_t>(kNumPoses));
  double as_read_rad = 0.0, in_time_rad = 0.0;
  for (int i = 2; i < kNumPoses; ++i) {
    const std::vector<Pose2>& poses = recording.trajectory.world_from_robot;
    const Pose2 step = Between(poses[i - 1], poses[i]);
    EXPECT_NEAR(steps[i].x, step.x, 1e-3);
    EXPECT_NEAR(steps[i].y, step.y, 1e-3);
    as_read_rad += std::abs(NormalizeAngle(recording.trajectory.odometry[i].yaw - step.yaw));
    in_time_rad += std::abs(NormalizeAngle(steps[i].yaw - step.yaw));
  }
  EXPECT_LT(in_time_rad, 0.1 * as_read_rad);
}

}  // namespace
}  // namespace plumbline
