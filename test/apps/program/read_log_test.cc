#include "plumbline/apps/program/read_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <string>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/carmen_writer.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

TEST(ReadLogTest, ReadsTheFirstScansAndCountsWhatDoesNotFit) {
  const std::string path = TempFolder() + "a.clf";
  WriteFile(path,
            "FLASER 2 1 2 0 0 0 0 0 0 1.0 host 0\n"
            "FLASER 2 1 oops 0 0 0 0 0 0 1.5 host 0\n"
            "FLASER 2 1 2 1 0 0 1 0 0 3.0 host 0\n"
            "FLASER 2 1 2 2 0 0 2 0 0 2.0 host 0\n");
  SlamGraph graph;
  LogNotes notes;
  testing::internal::CaptureStderr();
  const Status status = ReadLogIntoGraph(path, 2, &notes, &graph);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("skipped " + path + ":2: "));
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(graph.num_scans(), 2);
  EXPECT_EQ(graph.num_returns(), 4u);
  EXPECT_EQ(notes.counts.num_skipped_records, 1u);
  EXPECT_EQ(notes.counts.num_out_of_order, 1u);
}

TEST(ReadLogTest, BeamsInReverseOrderAreNoticed) {
  SimulatedLog log;
  SimulationOptions options;
  options.scan_period_s = 0.5;
  ASSERT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
  const std::string path = TempFolder() + "a.clf";
  for (const bool reversed : {false, true}) {
    if (reversed) {
      for (SimulatedScan& scan : log.scans) {
        std::reverse(scan.scan.ranges.begin(), scan.scan.ranges.end());
      }
    }
    ASSERT_TRUE(WriteCarmenLog(path, log).ok());
    SlamGraph graph;
    LogNotes notes;
    testing::internal::CaptureStderr();
    const Status status = ReadLogIntoGraph(path, 0, &notes, &graph);
    const std::string said = testing::internal::GetCapturedStderr();
    ASSERT_TRUE(status.ok()) << status.message();
    if (reversed) {
      EXPECT_THAT(said, HasSubstr("warning: " + path + ": the scans look mirrored: around "));
    } else {
      EXPECT_EQ(said, "");
    }
  }
}

// Writes the scans of a log as FLASER records.
void WriteFlaser(const std::string& path, const SimulatedLog& log) {
  std::ostringstream text;
  text << std::setprecision(12);
  for (const SimulatedScan& scan : log.scans) {
    text << "FLASER " << scan.scan.ranges.size();
    for (const double range_m : scan.scan.ranges) text << ' ' << range_m;
    for (int i = 0; i < 2; ++i) {
      const Pose2& pose = scan.odom_from_robot;
      text << ' ' << pose.x << ' ' << pose.y << ' ' << pose.yaw;
    }
    text << ' ' << scan.scan.timestamp_s << " host 0\n";
  }
  WriteFile(path, text.str());
}

TEST(ReadLogTest, TheTurnsTellWhatFlaserRecordsOf541BeamsCover) {
  const std::string path = TempFolder() + "a.clf";
  for (const double fov_deg : {180.0, 270.0}) {
    SimulationOptions options;
    options.scan_period_s = 0.5;
    options.laser.num_beams = 541;
    options.laser.first_bearing_rad = DegToRad(-0.5 * fov_deg);
    options.laser.bearing_step_rad = DegToRad(fov_deg / 540.0);
    SimulatedLog log;
    ASSERT_TRUE(Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log).ok());
    log.scans.resize(200);
    WriteFlaser(path, log);
    SlamGraph graph;
    LogNotes notes;
    ASSERT_TRUE(ReadLogIntoGraph(path, 0, &notes, &graph).ok());
    EXPECT_NEAR(RadToDeg(graph.laser(0).bearing_step_rad), fov_deg / 540.0, 1e-9);
    ASSERT_EQ(notes.warnings.size(), 1u);
    EXPECT_EQ(notes.warnings[0].id, "assumed_field_of_view");
  }
}

TEST(ReadLogTest, ALogWithoutReturnsIsAnError) {
  const std::string path = TempFolder() + "a.clf";
  WriteFile(path, "FLASER 2 nan nan 0 0 0 0 0 0 1.0 host 0\n");
  SlamGraph graph;
  LogNotes notes;
  const Status status = ReadLogIntoGraph(path, 0, &notes, &graph);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr(path + ": no scan has a return"));
  EXPECT_EQ(graph.num_scans(), 0);
}

TEST(ReadLogTest, ABagIsToldByItsFirstLine) {
  const std::string path = TempFolder() + "a.clf";
  WriteFile(path, "#ROSBAG V2.0\n");
  SlamGraph graph;
  LogNotes notes;
  const Status status = ReadLogIntoGraph(path, 0, &notes, &graph);
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(status.message(), HasSubstr(path + ": cannot be read as a ROS bag"));
}

}  // namespace
}  // namespace plumbline
