#include "plumbline/apps/benchmark/corrected_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace plumbline {
namespace {

// A robot that drives along x; its laser sits 0.1 m ahead. Scan i reads i.
CarmenLog RawLog(int num_scans) {
  CarmenLog log;
  for (int i = 0; i < num_scans; ++i) {
    CarmenScan scan;
    scan.timestamp_s = 1000.0 + i;
    scan.odom_from_robot = {1.0 * i, 0.0, 0.0};
    scan.odom_from_laser = {1.0 * i + 0.1, 0.0, 0.0};
    scan.ranges.assign(2, 1.0 * i);
    log.scans.push_back(scan);
  }
  return log;
}

// What a mapper makes of it that turns the drive by 90 degrees: both poses are those of the laser,
// and the clock is another one.
CarmenScan Corrected(const CarmenScan& raw) {
  CarmenScan scan = raw;
  scan.timestamp_s = 0.3 * raw.timestamp_s;
  scan.odom_from_laser = scan.odom_from_robot = {0.0, raw.odom_from_laser.x, 0.5 * kPi};
  return scan;
}

TEST(CorrectedLogTest, ScansPairByTheirRangesAndTheRobotStandsBehindItsLaser) {
  const CarmenLog raw = RawLog(10);
  CarmenLog corrected;
  for (const int i : {1, 2, 5, 9}) corrected.scans.push_back(Corrected(raw.scans[i]));
  CorrectedLog pair;
  ASSERT_TRUE(PairCorrectedLog(raw, corrected, &pair).ok());
  ASSERT_EQ(pair.raw.scans.size(), 4u);
  ASSERT_EQ(pair.corrected.scans.size(), 4u);
  EXPECT_EQ(pair.raw.scans[2].timestamp_s, 1005.0);
  EXPECT_EQ(pair.raw.scans[2].odom_from_robot.x, 5.0);
  const CarmenScan& scan = pair.corrected.scans[2];
  EXPECT_EQ(scan.timestamp_s, 1005.0);
  EXPECT_NEAR(scan.odom_from_robot.x, 0.0, 1e-12);
  EXPECT_NEAR(scan.odom_from_robot.y, 5.0, 1e-12);
  EXPECT_NEAR(scan.odom_from_laser.y, 5.1, 1e-12);
}

TEST(CorrectedLogTest, EqualScansPairInTheirOrder) {
  CarmenLog raw = RawLog(6), corrected;
  for (CarmenScan& scan : raw.scans) scan.ranges.assign(1, 2.0);
  for (const CarmenScan& scan : raw.scans) corrected.scans.push_back(Corrected(scan));
  CorrectedLog pair;
  ASSERT_TRUE(PairCorrectedLog(raw, corrected, &pair).ok());
  ASSERT_EQ(pair.raw.scans.size(), 6u);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(pair.raw.scans[i].timestamp_s, 1000.0 + i);
}

TEST(CorrectedLogTest, AScanThatTheRawLogLacksIsLeftOut) {
  const CarmenLog raw = RawLog(4);
  CarmenLog corrected;
  for (const CarmenScan& scan : raw.scans) corrected.scans.push_back(Corrected(scan));
  corrected.scans[1].ranges.assign(2, 7.5);
  CorrectedLog pair;
  ASSERT_TRUE(PairCorrectedLog(raw, corrected, &pair).ok());
  EXPECT_EQ(pair.raw.scans.size(), 3u);
}

TEST(CorrectedLogTest, AnotherDriveIsRefused) {
  const CarmenLog raw = RawLog(4);
  CarmenLog other = RawLog(4);
  for (CarmenScan& scan : other.scans) scan.ranges.assign(1, 9.0);
  CorrectedLog pair;
  const Status status = PairCorrectedLog(raw, other, &pair);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), testing::HasSubstr("only 0 of 4"));
  EXPECT_TRUE(pair.raw.scans.empty());
}

}  // namespace
}  // namespace plumbline
