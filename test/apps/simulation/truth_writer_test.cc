#include "plumbline/apps/simulation/truth_writer.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

SimulatedLog TwoScans() {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  SimulatedLog log;
  log.scans.resize(2);
  log.scans[0].world_from_robot = Pose2(1.0, 2.0, 0.5);
  log.scans[0].hits = {{1.5, -2.25}, {kNaN, kNaN}, {3.0, 4.0}};
  log.scans[1].scan.timestamp_s = 0.3;
  log.scans[1].world_from_robot = Pose2(3.0, 4.0, -3.0);
  log.scans[1].odom_from_robot = Pose2(9.0, 9.0, 9.0);
  log.scans[1].hits = {{kNaN, kNaN}, {0.1234567, 1.0}};
  return log;
}

TEST(TruthWriterTest, TrajectoryIsTheTrueOne) {
  const std::string path = TempFolder() + "a.tum";
  ASSERT_TRUE(WriteTrueTrajectory(path, TwoScans()).ok());
  std::vector<TimedPose> trajectory;
  ASSERT_TRUE(ReadTumTrajectory(path, &trajectory).ok());
  ASSERT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(trajectory[1].timestamp_s, 0.3);
  EXPECT_NEAR(trajectory[1].world_from_robot.x, 3.0, 1e-9);
  EXPECT_NEAR(trajectory[1].world_from_robot.y, 4.0, 1e-9);
  EXPECT_NEAR(trajectory[1].world_from_robot.yaw, -3.0, 1e-8);
}

TEST(TruthWriterTest, HitsHaveOneLinePerReturn) {
  const std::string path = TempFolder() + "a.hits";
  ASSERT_TRUE(WriteTrueHits(path, TwoScans()).ok());
  EXPECT_EQ(ReadFile(path),
            "0.000000 0 1.500000 -2.250000\n"
            "0.000000 2 3.000000 4.000000\n"
            "0.300000 1 0.123457 1.000000\n");
}

TEST(TruthWriterTest, ReportsAFolderThatDoesNotExist) {
  EXPECT_EQ(WriteTrueHits(TempFolder() + "none/a", TwoScans()).code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
