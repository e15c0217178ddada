#include "plumbline/apps/io/robot_laser_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

TEST(RobotLaserRecordTest, HasTheFieldsThatTheFormatNames) {
  CarmenScan scan;
  scan.timestamp_s = 12.5;
  scan.odom_from_laser = {1.25, 2.0, 0.5};
  scan.odom_from_robot = {1.0, 2.0, 0.5};
  scan.ranges = {1.5, 0.1, 84.0};
  scan.first_bearing_rad = -0.25;
  scan.bearing_step_rad = 0.25;
  scan.max_range_m = 82.0;
  EXPECT_EQ(RobotLaserRecord(scan),
            "ROBOTLASER1 0 -0.25 0.5 0.25 82 0 0 3 1.5 0.1 84 0 1.25 2 0.5 1 2 0.5 0 0 0 0 0 12.5 "
            "plumbline 12.5");
}

TEST(RobotLaserRecordTest, ReadsBackToTheLastBit) {
  CarmenScan scan;
  scan.timestamp_s = 976052857.337123;
  scan.odom_from_laser = {1e6 / 3.0, -1e-17, kPi / 7.0};
  scan.odom_from_robot = {5e6 / 7.0, 1e6 + 0.1, -kPi};
  scan.ranges = {1.0 / 3.0, 12.34, 29.9999, 31.0, std::numeric_limits<double>::quiet_NaN()};
  scan.first_bearing_rad = -0.75 * kPi;
  scan.bearing_step_rad = kPi / 511.0;
  scan.max_range_m = 30.0;
  const std::string path = TempFolder() + "a.log";
  WriteFile(path, RobotLaserRecord(scan) + "\n");
  CarmenLog log;
  const Status status = ReadCarmenLog(path, CarmenReadOptions(), &log);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(log.scans.size(), 1u);
  EXPECT_EQ(log.num_issues, 0u);
  const CarmenScan& read = log.scans[0];
  EXPECT_EQ(read.timestamp_s, scan.timestamp_s);
  EXPECT_EQ(read.odom_from_laser.x, scan.odom_from_laser.x);
  EXPECT_EQ(read.odom_from_laser.y, scan.odom_from_laser.y);
  EXPECT_EQ(read.odom_from_laser.yaw, scan.odom_from_laser.yaw);
  EXPECT_EQ(read.odom_from_robot.x, scan.odom_from_robot.x);
  EXPECT_EQ(read.odom_from_robot.y, scan.odom_from_robot.y);
  EXPECT_EQ(read.odom_from_robot.yaw, scan.odom_from_robot.yaw);
  EXPECT_EQ(read.first_bearing_rad, scan.first_bearing_rad);
  EXPECT_EQ(read.bearing_step_rad, scan.bearing_step_rad);
  EXPECT_EQ(read.max_range_m, scan.max_range_m);
  ASSERT_EQ(read.ranges.size(), scan.ranges.size());
  for (std::size_t i = 0; i + 1 < scan.ranges.size(); ++i) {
    EXPECT_EQ(read.ranges[i], scan.ranges[i]) << i;
  }
  EXPECT_TRUE(std::isnan(read.ranges.back()));
}

}  // namespace
}  // namespace plumbline
