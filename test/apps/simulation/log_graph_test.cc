#include "plumbline/apps/simulation/log_graph.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

SimulatedLog TwoScans() {
  SimulatedLog log;
  log.laser.num_beams = 3;
  log.laser.bearing_step_rad = 0.5;
  log.laser.max_range_m = 10.0;
  log.scans.resize(2);
  log.scans[0].scan = {0.0, {1.0, 10.0, 2.0}};
  log.scans[0].odom_from_robot = {5.0, 1.0, kPi / 2};
  log.scans[1].scan = {0.5, {1.0, 3.0, 2.0}};
  log.scans[1].odom_from_robot = {5.0, 1.4, kPi / 2 + 0.1};
  return log;
}

TEST(LogGraphTest, PosesFollowTheOdometryFromTheOrigin) {
  SlamGraph graph;
  ASSERT_TRUE(MakeGraph(TwoScans(), &graph).ok());
  ASSERT_EQ(graph.num_poses(), 2);
  EXPECT_EQ(graph.num_scans(), 2);
  EXPECT_EQ(graph.num_returns(), 5u);  // one reading is at the maximum
  EXPECT_EQ(graph.timestamp_s(1), 0.5);
  EXPECT_EQ(graph.InitialPose(0).x, 0.0);
  EXPECT_NEAR(graph.InitialPose(1).x, 0.4, 1e-12);
  EXPECT_NEAR(graph.InitialPose(1).y, 0.0, 1e-12);
  EXPECT_NEAR(graph.InitialPose(1).yaw, 0.1, 1e-12);
  ASSERT_EQ(graph.odometry().size(), 1u);
  EXPECT_NEAR(graph.odometry()[0].from_from_to.x, 0.4, 1e-12);
}

TEST(LogGraphTest, ARefusedLogLeavesTheGraphAlone) {
  SlamGraph graph;
  ASSERT_TRUE(MakeGraph(TwoScans(), &graph).ok());
  SimulatedLog log = TwoScans();
  log.scans[1].scan.ranges.pop_back();
  EXPECT_EQ(MakeGraph(log, &graph).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(graph.num_poses(), 2);
}

}  // namespace
}  // namespace plumbline
