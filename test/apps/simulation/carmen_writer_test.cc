#include "plumbline/apps/simulation/carmen_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A room with a pillar, and a laser that is mounted askew.
SimulatedLog Simulated(int num_beams, double first_bearing_deg, double step_deg,
                       std::uint64_t seed) {
  Building building;
  building.faces = {{{0, 0}, {9, 0}}, {{9, 0}, {9, 6}}, {{9, 6}, {0, 6}}};  // one side is open
  building.discs = {{{6, 4.5}, 0.4}};
  building.path = {{{2, 3}, 1}, {{5, 3}, 2}, {{5, 5}, 3}};
  SimulationOptions options;
  options.laser.num_beams = num_beams;
  options.laser.first_bearing_rad = DegToRad(first_bearing_deg);
  options.laser.bearing_step_rad = DegToRad(step_deg);
  options.laser.max_range_m = 29.9996;
  options.laser.robot_from_laser = Pose2(0.12, -0.03, 0.2);
  options.seed = seed;
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(building), options, &log).ok());
  return log;
}

void ExpectNear(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x, b.x, 1e-6);
  EXPECT_NEAR(a.y, b.y, 1e-6);
  EXPECT_NEAR(NormalizeAngle(a.yaw - b.yaw), 0.0, 1e-6);
}

void ExpectReadsBack(const SimulatedLog& log, const std::string& record) {
  const std::string path = TempFolder() + "a.clf";
  ASSERT_TRUE(WriteCarmenLog(path, log).ok());
  EXPECT_THAT(ReadFile(path), HasSubstr("\n" + record + " "));
  CarmenLog read;
  const Status status = ReadCarmenLog(path, CarmenReadOptions(), &read);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(read.num_issues, 0u);
  EXPECT_EQ(read.params.at("robot_frontlaser_offset"), "0.120000");
  ASSERT_EQ(read.scans.size(), log.scans.size());
  constexpr std::size_t kNumParams = 2;
  ASSERT_EQ(read.num_records, kNumParams + 2 * log.scans.size());  // an ODOM for each scan
  int lost = 0;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const SimulatedScan& expected = log.scans[i];
    const CarmenScan& actual = read.scans[i];
    EXPECT_NEAR(actual.timestamp_s, expected.scan.timestamp_s, 1e-9);
    ExpectNear(actual.odom_from_robot, expected.odom_from_robot);
    ExpectNear(actual.odom_from_laser, expected.odom_from_robot * log.laser.robot_from_laser);
    ASSERT_EQ(actual.ranges.size(), expected.scan.ranges.size());
    EXPECT_NEAR(actual.first_bearing_rad, log.laser.first_bearing_rad, 1e-9);
    EXPECT_NEAR(actual.bearing_step_rad, log.laser.bearing_step_rad, 1e-9);
    for (std::size_t beam = 0; beam < actual.ranges.size(); ++beam) {
      const bool is_return = log.laser.IsReturn(expected.scan.ranges[beam]);
      EXPECT_EQ(actual.ranges[beam] < actual.max_range_m, is_return);
      if (is_return) {
        EXPECT_EQ(actual.ranges[beam], expected.scan.ranges[beam]);
      } else {
        ++lost;
      }
    }
  }
  EXPECT_GT(lost, 0);
}

TEST(CarmenWriterTest, EvenNumberOfBeamsOverAHalfCircleIsFlaser) {
  ExpectReadsBack(Simulated(360, -90.0, 0.5, 1), "FLASER 360");
}

TEST(CarmenWriterTest, OddNumberOfBeamsOverAHalfCircleIsFlaser) {
  ExpectReadsBack(Simulated(181, -90.0, 1.0, 1), "FLASER 181");
}

TEST(CarmenWriterTest, OtherBeamsAreRobotlaser) {
  ExpectReadsBack(Simulated(720, -180.0, 0.5, 1), "ROBOTLASER1 0");
  ExpectReadsBack(Simulated(181, -60.0, 1.0 / 3.0, 1), "ROBOTLASER1 0");
}

TEST(CarmenWriterTest, RecordsHaveTheFieldsThatTheFormatNames) {
  SimulatedLog log;
  log.laser.num_beams = 2;
  log.laser.first_bearing_rad = -kPi / 2;
  log.laser.bearing_step_rad = kPi / 2;
  log.laser.robot_from_laser = Pose2(0.25, 0.0, 0.0);
  for (const double time_s : {0.0, 0.5}) {
    SimulatedScan scan;
    scan.scan.timestamp_s = time_s;
    scan.scan.ranges = {1.5, 80.0};
    scan.odom_from_robot = Pose2(2.0, 1.0 + time_s, kPi / 2);
    log.scans.push_back(scan);
  }
  const std::string path = TempFolder() + "a.clf";
  ASSERT_TRUE(WriteCarmenLog(path, log).ok());
  EXPECT_EQ(ReadFile(path),
            "PARAM robot_frontlaser_offset 0.250000 0.000000 simulator 0.000000\n"
            "PARAM robot_front_laser_max 80.000 0.000000 simulator 0.000000\n"
            "ODOM 2.000000 1.000000 1.570796 0.000000 0.000000 0 0.000000 simulator 0.000000\n"
            "FLASER 2 1.500 80.000 2.000000 1.250000 1.570796 2.000000 1.000000 1.570796 "
            "0.000000 simulator 0.000000\n"
            "ODOM 2.000000 1.500000 1.570796 1.000000 0.000000 0 0.500000 simulator 0.500000\n"
            "FLASER 2 1.500 80.000 2.000000 1.750000 1.570796 2.000000 1.500000 1.570796 "
            "0.500000 simulator 0.500000\n");
}

TEST(CarmenWriterTest, SameSeedSameBytes) {
  const std::string folder = TempFolder();
  ASSERT_TRUE(WriteCarmenLog(folder + "a", Simulated(360, -90.0, 0.5, 1)).ok());
  ASSERT_TRUE(WriteCarmenLog(folder + "b", Simulated(360, -90.0, 0.5, 1)).ok());
  ASSERT_TRUE(WriteCarmenLog(folder + "c", Simulated(360, -90.0, 0.5, 2)).ok());
  EXPECT_EQ(ReadFile(folder + "a"), ReadFile(folder + "b"));
  EXPECT_NE(ReadFile(folder + "a"), ReadFile(folder + "c"));
}

TEST(CarmenWriterTest, ReportsAFolderThatDoesNotExist) {
  EXPECT_EQ(WriteCarmenLog(TempFolder() + "none/a.clf", SimulatedLog()).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
