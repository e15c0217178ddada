#include "plumbline/apps/io/log_to_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const Pose2 kRobotFromLaser(-0.04, 0.01, 0.05);

CarmenScan MakeScan(double timestamp_s, const Pose2& odom_from_robot, int num_beams = 3) {
  CarmenScan scan;
  scan.timestamp_s = timestamp_s;
  scan.odom_from_robot = odom_from_robot;
  scan.odom_from_laser = odom_from_robot * kRobotFromLaser;
  scan.ranges.assign(num_beams, 2.0);
  scan.first_bearing_rad = -0.5 * kPi;
  scan.bearing_step_rad = 0.5 * kPi;
  scan.max_range_m = 10.0;
  scan.line = 17;
  return scan;
}

/// The robot starts at (5, 3) looking along y, drives 2 m ahead, then turns left and drives 1 m.
CarmenLog MakeLog() {
  CarmenLog log;
  log.scans = {MakeScan(100.0, {5.0, 3.0, DegToRad(90.0)}),
               MakeScan(101.0, {5.0, 5.0, DegToRad(180.0)}),
               MakeScan(102.0, {4.0, 5.0, DegToRad(-180.0)})};
  log.scans[1].ranges[0] = 10.0;  // No return.
  return log;
}

void ExpectPose(const Pose2& pose, double x, double y, double yaw) {
  EXPECT_NEAR(pose.x, x, 1e-12);
  EXPECT_NEAR(pose.y, y, 1e-12);
  EXPECT_NEAR(NormalizeAngle(pose.yaw - yaw), 0.0, 1e-12);
}

TEST(LogToGraphTest, TheFirstPoseIsTheOriginAndOdometryJoinsTheRest) {
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(MakeLog(), 0, &graph).ok());
  ASSERT_EQ(graph.num_poses(), 3);
  ASSERT_EQ(graph.num_scans(), 3);
  EXPECT_EQ(graph.num_returns(), 8u);
  EXPECT_EQ(graph.timestamp_s(2), 102.0);
  ExpectPose(graph.InitialPose(0), 0.0, 0.0, 0.0);
  ExpectPose(graph.InitialPose(1), 2.0, 0.0, DegToRad(90.0));
  ExpectPose(graph.InitialPose(2), 2.0, 1.0, DegToRad(90.0));
  ASSERT_EQ(graph.odometry().size(), 2u);
  EXPECT_EQ(graph.odometry()[1].from, 1);
  EXPECT_EQ(graph.odometry()[1].to, 2);
  ExpectPose(graph.odometry()[0].from_from_to, 2.0, 0.0, DegToRad(90.0));
  ExpectPose(graph.odometry()[1].from_from_to, 1.0, 0.0, 0.0);
}

TEST(LogToGraphTest, TheLaserSitsWhereTheLogSays) {
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(MakeLog(), 0, &graph).ok());
  const LaserModel& laser = graph.LaserOfScan(0);
  ExpectPose(laser.robot_from_laser, -0.04, 0.01, 0.05);
  EXPECT_EQ(laser.num_beams, 3);
  EXPECT_EQ(laser.max_range_m, 10.0);
  EXPECT_EQ(graph.scan(2).laser, graph.scan(0).laser);
  // The middle beam of the first scan looks along the laser's x axis.
  const std::vector<double> points = graph.MeasuredMap(graph.initial_poses());
  EXPECT_NEAR(points[2], -0.04 + 2.0 * std::cos(0.05), 1e-12);
  EXPECT_NEAR(points[3], 0.01 + 2.0 * std::sin(0.05), 1e-12);
}

TEST(LogToGraphTest, EachGeometryHasItsOwnLaser) {
  CarmenLog log = MakeLog();
  log.scans.push_back(MakeScan(103.0, {4.0, 5.0, 0.0}, 2));
  log.scans.push_back(MakeScan(104.0, {4.0, 5.0, 0.0}));
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(log, 0, &graph).ok());
  EXPECT_EQ(graph.LaserOfScan(3).num_beams, 2);
  EXPECT_NE(graph.scan(3).laser, graph.scan(0).laser);
  EXPECT_EQ(graph.scan(4).laser, graph.scan(0).laser);
}

TEST(LogToGraphTest, MaxScansTakesTheFirst) {
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(MakeLog(), 2, &graph).ok());
  EXPECT_EQ(graph.num_poses(), 2);
  EXPECT_EQ(graph.odometry().size(), 1u);
  ASSERT_TRUE(BuildGraph(MakeLog(), 99, &graph).ok());
  EXPECT_EQ(graph.num_poses(), 3);
}

TEST(LogToGraphTest, ALogThatIsOfNoMoreUseGivesTheSameGraphAndIsFreedOnTheWay) {
  CarmenLog log = MakeLog();
  for (int i = 0; i < 90; ++i) {
    CarmenScan& scan = log.scans.emplace_back(MakeScan(200.0 + i, {4.0, 5.0, 0.1 * i}, 100000));
    scan.bearing_step_rad = 1e-6;  // 800 kB of readings
  }
  SlamGraph kept, freed;
  ASSERT_TRUE(BuildGraph(log, 0, &kept).ok());
  int num_calls = 0;
  ASSERT_TRUE(BuildGraph(
                  std::move(log), 0, [&] { ++num_calls; }, &freed)
                  .ok());
  EXPECT_EQ(num_calls, 2);
  EXPECT_EQ(freed.returns().range_m, kept.returns().range_m);
  EXPECT_EQ(freed.num_scans(), kept.num_scans());
  EXPECT_EQ(freed.odometry().size(), kept.odometry().size());
}

TEST(LogToGraphTest, MountingIsAMedianAndItsDeviationsAreReported) {
  CarmenLog log = MakeLog();
  LaserMounting mounting = EstimateLaserMounting(log);
  EXPECT_LT(mounting.max_deviation_m, 1e-12);
  EXPECT_LT(mounting.max_deviation_rad, 1e-12);

  log.scans[1].odom_from_laser =
      log.scans[1].odom_from_robot * kRobotFromLaser * Pose2(0.3, 0.4, -0.2);
  mounting = EstimateLaserMounting(log);
  ExpectPose(mounting.robot_from_laser, -0.04, 0.01, 0.05);
  EXPECT_NEAR(mounting.max_deviation_m, 0.5, 1e-12);
  EXPECT_NEAR(mounting.max_deviation_rad, 0.2, 1e-12);
}

TEST(LogToGraphTest, MountingsDisagreeFromMoreThanRoundingOn) {
  LaserMounting mounting;
  mounting.max_deviation_m = mounting.max_deviation_rad = 0.05;
  EXPECT_EQ(mounting.Disagreement(), "");
  mounting.max_deviation_m = 0.5;
  mounting.max_deviation_rad = 0.0;
  EXPECT_EQ(mounting.Disagreement(),
            "the place of the laser on the robot differs by up to 0.5 m and 0 deg between scans");
  mounting.max_deviation_m = 0.0;
  mounting.max_deviation_rad = DegToRad(9.0);
  EXPECT_THAT(mounting.Disagreement(), HasSubstr("0 m and 9 deg"));
}

TEST(LogToGraphTest, ALaserThatLooksBackwardsIsNoMixOfBothSigns) {
  CarmenLog log = MakeLog();
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const double rounding = i % 2 == 0 ? 1e-6 : -1e-6;
    log.scans[i].odom_from_laser = log.scans[i].odom_from_robot * Pose2(0.0, 0.0, kPi + rounding);
  }
  const LaserMounting mounting = EstimateLaserMounting(log);
  EXPECT_NEAR(std::abs(mounting.robot_from_laser.yaw), kPi, 1.1e-6);
  EXPECT_LT(mounting.max_deviation_rad, 2.1e-6);
}

TEST(LogToGraphTest, OdometryThatNeverChangesIsNone) {
  CarmenLog log = MakeLog();
  for (CarmenScan& scan : log.scans) scan = MakeScan(scan.timestamp_s, {5.0, 3.0, 1.0});
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(log, 0, &graph).ok());
  EXPECT_EQ(graph.num_poses(), 3);
  EXPECT_TRUE(graph.odometry().empty());
  ExpectPose(graph.laser(0).robot_from_laser, kRobotFromLaser.x, kRobotFromLaser.y,
             kRobotFromLaser.yaw);
}

TEST(LogToGraphTest, OdometryThatChangesLaterIsSomeForTheFirstScansToo) {
  CarmenLog log = MakeLog();
  log.scans[1] = MakeScan(101.0, log.scans[0].odom_from_robot);
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(log, 2, &graph).ok());
  EXPECT_EQ(graph.odometry().size(), 1u);
}

TEST(LogToGraphTest, WithoutPosesTheParameterSaysWhereTheLaserSits) {
  CarmenLog log = MakeLog();
  for (CarmenScan& scan : log.scans) scan.odom_from_robot = scan.odom_from_laser = Pose2();
  log.params["robot_frontlaser_offset"] = "-0.04";
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(log, 0, &graph).ok());
  ExpectPose(graph.laser(0).robot_from_laser, -0.04, 0.0, 0.0);
  log.params["robot_frontlaser_offset"] = "off";
  ASSERT_TRUE(BuildGraph(log, 0, &graph).ok());
  ExpectPose(graph.laser(0).robot_from_laser, 0.0, 0.0, 0.0);
}

TEST(LogToGraphTest, BadInputIsNamedAndLeavesTheGraph) {
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(MakeLog(), 0, &graph).ok());
  EXPECT_EQ(BuildGraph(CarmenLog(), 0, &graph).code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(BuildGraph(MakeLog(), -1, &graph).message(), HasSubstr("max_scans = -1"));
  CarmenLog log = MakeLog();
  log.scans[1].bearing_step_rad = 0.0;
  EXPECT_THAT(BuildGraph(log, 0, &graph).message(), HasSubstr("scan of line 17: laser 1: "));
  EXPECT_EQ(graph.num_poses(), 3);
}

// Counted with awk: readings from 0.05 m to below 80.99 m.
TEST(LogToGraphDatasetTest, Fr079) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "set PLUMBLINE_DATASETS to the folder of the logs";
  CarmenLog log;
  ASSERT_TRUE(ReadCarmenLog(DatasetsFolder() + "/fr079.clf.gz", {}, &log).ok());
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(log, 0, &graph).ok());
  EXPECT_EQ(graph.num_poses(), 4934);
  EXPECT_EQ(graph.num_returns(), 1739359u);
  // The log's own PARAM robot_frontlaser_offset is -0.04; poses have six decimals.
  const LaserMounting mounting = EstimateLaserMounting(log);
  EXPECT_NEAR(mounting.robot_from_laser.x, -0.04, 1e-6);
  EXPECT_NEAR(mounting.robot_from_laser.y, 0.0, 1e-6);
  EXPECT_LT(mounting.max_deviation_m, 3e-6);
}

}  // namespace
}  // namespace plumbline
