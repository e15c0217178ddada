#include "plumbline/apps/simulation/log_faults.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace plumbline {
namespace {

// One scan per second, 0.1 m apart; each has a reading and a true point of its own.
SimulatedLog Log(int num_scans) {
  SimulatedLog log;
  log.laser.num_beams = 2;
  log.laser.bearing_step_rad = 0.5;
  log.path_length_m = 0.1 * (num_scans - 1);
  for (int i = 0; i < num_scans; ++i) {
    SimulatedScan scan;
    scan.scan = {1.0 * i, {1.0 + 0.1 * i, 80.0}};
    scan.world_from_robot = Pose2(0.1 * i, 0.0, 0.0);
    scan.odom_from_robot = Pose2(0.11 * i, 0.0, 0.01 * i);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    scan.hits = {{0.1 * i, 1.0}, {nan, nan}};
    log.scans.push_back(scan);
  }
  return log;
}

std::vector<double> Times(const SimulatedLog& log) {
  std::vector<double> times;
  for (const SimulatedScan& scan : log.scans) times.push_back(scan.scan.timestamp_s);
  return times;
}

// But for the time.
void ExpectSameRecord(const SimulatedScan& a, const SimulatedScan& b) {
  EXPECT_EQ(a.scan.ranges, b.scan.ranges);
  EXPECT_EQ(a.hits[0], b.hits[0]);
  EXPECT_EQ(a.world_from_robot.x, b.world_from_robot.x);
  EXPECT_EQ(a.odom_from_robot.x, b.odom_from_robot.x);
  EXPECT_EQ(a.odom_from_robot.yaw, b.odom_from_robot.yaw);
}

TEST(LogFaultsTest, DroppedScansLeaveAHoleAndTheOdometryAlone) {
  const SimulatedLog sound = Log(8);
  SimulatedLog log = sound;
  EXPECT_EQ(DropScans(2.0, 3.0, &log), 2u);
  EXPECT_EQ(Times(log), (std::vector<double>{0, 1, 5, 6, 7}));
  ExpectSameRecord(log.scans[1], sound.scans[1]);
  ExpectSameRecord(log.scans[2], sound.scans[5]);
}

TEST(LogFaultsTest, TheFirstScanIsNeverDropped) {
  SimulatedLog log = Log(4);
  EXPECT_EQ(DropScans(0.0, 100.0, &log), 1u);
  EXPECT_EQ(Times(log), std::vector<double>{0});
  EXPECT_EQ(DropScans(50.0, 100.0, &log), 1u);
  EXPECT_EQ(log.scans.size(), 1u);
}

TEST(LogFaultsTest, AFrozenLaserRepeatsItsRangesWhileTheOdometryGoesOn) {
  const SimulatedLog sound = Log(8);
  SimulatedLog log = sound;
  EXPECT_EQ(FreezeLaser(2.5, 3.0, &log), 3u);
  EXPECT_EQ(Times(log), Times(sound));
  for (int i = 0; i < 8; ++i) {
    const SimulatedScan& seen = sound.scans[i < 3 || i > 5 ? i : 2];
    EXPECT_EQ(log.scans[i].scan.ranges, seen.scan.ranges) << i;
    EXPECT_EQ(log.scans[i].hits[0], seen.hits[0]) << i;
    EXPECT_EQ(log.scans[i].odom_from_robot.x, sound.scans[i].odom_from_robot.x);
    EXPECT_EQ(log.scans[i].world_from_robot.x, sound.scans[i].world_from_robot.x);
  }
}

TEST(LogFaultsTest, ALaserFrozenToTheEndNeverRecovers) {
  SimulatedLog log = Log(8);
  EXPECT_EQ(FreezeLaser(5.0, std::numeric_limits<double>::infinity(), &log), 6u);
  EXPECT_NE(log.scans[4].scan.ranges, log.scans[5].scan.ranges);
  for (int i = 6; i < 8; ++i) EXPECT_EQ(log.scans[i].scan.ranges, log.scans[5].scan.ranges);
  EXPECT_EQ(FreezeLaser(7.0, 1.0, &log), 8u);
}

TEST(LogFaultsTest, ARepeatedStretchComesAgainLaterWithTheSameRecords) {
  const SimulatedLog sound = Log(8);
  SimulatedLog log = sound;
  EXPECT_EQ(RepeatStretch(2.0, 3.0, &log), 5u);
  EXPECT_EQ(Times(log), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  const int origins[] = {0, 1, 2, 3, 4, 2, 3, 4, 5, 6, 7};
  for (int i = 0; i < 11; ++i) ExpectSameRecord(log.scans[i], sound.scans[origins[i]]);
}

TEST(LogFaultsTest, TheEndCanBeRepeatedAndTimeGoesOn) {
  SimulatedLog log = Log(4);
  EXPECT_EQ(RepeatStretch(2.0, 10.0, &log), 4u);
  EXPECT_EQ(Times(log), (std::vector<double>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(RepeatStretch(2.2, 0.5, &log), 6u);  // between two scans
  EXPECT_EQ(log.scans.size(), 6u);
}

TEST(LogFaultsTest, AnotherLogGoesOnFromTheLastPoseWithItsOwnMotions) {
  const SimulatedLog original = Log(3);
  SimulatedLog next = original;
  for (SimulatedScan& scan : next.scans) {
    scan.world_from_robot = Pose2(5.0, -2.0, 1.0) * scan.world_from_robot;
    scan.hits[0] = Pose2(5.0, -2.0, 1.0) * scan.hits[0];
    scan.odom_from_robot = Pose2(0.0, 7.0, -3.0) * scan.odom_from_robot;
    scan.scan.ranges[0] += 10.0;
  }
  SimulatedLog log = Log(4);
  std::size_t first = 0;
  ASSERT_TRUE(AppendLog(next, &log, &first).ok());
  EXPECT_EQ(first, 4u);
  EXPECT_EQ(Times(log), (std::vector<double>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_NEAR(log.path_length_m, 0.5, 1e-12);
  for (int i = 0; i < 3; ++i) {
    const SimulatedScan &scan = log.scans[4 + i], &own = original.scans[i];
    const Pose2 driven = Between(log.scans[3].world_from_robot, scan.world_from_robot);
    const Pose2 reported = Between(log.scans[3].odom_from_robot, scan.odom_from_robot);
    EXPECT_NEAR(driven.x, own.world_from_robot.x, 1e-12);
    EXPECT_NEAR(driven.y, 0.0, 1e-12);
    EXPECT_NEAR(reported.x, own.odom_from_robot.x, 1e-12);
    EXPECT_NEAR(reported.yaw, own.odom_from_robot.yaw, 1e-12);
    EXPECT_EQ(scan.scan.ranges[0], own.scan.ranges[0] + 10.0);
    const Eigen::Vector2d hit = log.scans[3].world_from_robot.Inverse() * scan.hits[0];
    EXPECT_NEAR((hit - own.hits[0]).norm(), 0.0, 1e-12);
    EXPECT_TRUE(std::isnan(scan.hits[1].x()));
  }
}

TEST(LogFaultsTest, ALogOfAnotherLaserIsRefused) {
  SimulatedLog log = Log(4), next = Log(3);
  std::size_t first = 77;
  next.laser.max_range_m = 30.0;
  EXPECT_EQ(AppendLog(next, &log, &first).code(), StatusCode::kInvalidArgument);
  next = Log(0);
  EXPECT_EQ(AppendLog(next, &log, &first).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(log.scans.size(), 4u);
  EXPECT_EQ(first, 77u);
}

}  // namespace
}  // namespace plumbline
