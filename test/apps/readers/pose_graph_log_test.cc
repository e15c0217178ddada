#include "plumbline/apps/readers/pose_graph_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {
namespace {

class PoseGraphLogTest : public testing::Test {
 protected:
  PoseGraphLogTest() {
    for (const double yaw : {0.0, 1.0}) {  // two lasers
      LaserModel laser;
      laser.num_beams = 3;
      laser.bearing_step_rad = 0.1;
      laser.max_range_m = 10.0;
      laser.robot_from_laser.yaw = yaw;
      graph_.AddLaser(laser);
    }
    const double times[] = {5.0, 1.0, 3.0};
    for (int pose = 0; pose < 3; ++pose) {
      graph_.AddPose(Pose2(pose, 0.0, 0.0), times[pose]);
    }
    for (const int pose : {0, 1, 1}) {
      graph_.AddScan(pose, graph_.num_scans() % 2, {1.0, 2.0, 3.0});
    }
  }

  SlamGraph graph_;
};

TEST_F(PoseGraphLogTest, HasThePosesWithScansInTheirOrder) {
  SlamGraph log;
  ASSERT_TRUE(LogOfPoseGraph(graph_, 0, &log).ok());
  ASSERT_EQ(log.num_poses(), 2);
  EXPECT_EQ(log.timestamp_s(0), 5.0);
  EXPECT_EQ(log.timestamp_s(1), 1.0);
  EXPECT_EQ(log.InitialPose(1).x, 1.0);
  ASSERT_EQ(log.num_scans(), 3);  // two of one pose
  EXPECT_EQ(log.scan(2).pose, 1);
  EXPECT_EQ(log.LaserOfScan(1).robot_from_laser.yaw, 1.0);
  ASSERT_EQ(log.odometry().size(), 1u);
  EXPECT_EQ(log.odometry().front().from_from_to.x, 1.0);
  EXPECT_TRUE(log.relative_poses().empty());
}

TEST_F(PoseGraphLogTest, TakesTheFirstScansOnly) {
  SlamGraph log;
  ASSERT_TRUE(LogOfPoseGraph(graph_, 1, &log).ok());
  EXPECT_EQ(log.num_scans(), 1);
  EXPECT_EQ(log.num_poses(), 1);
}

TEST_F(PoseGraphLogTest, NeedsScans) {
  SlamGraph empty, log;
  empty.AddPose(Pose2(), 0.0);
  const Status status = LogOfPoseGraph(empty, 0, &log);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), testing::HasSubstr("without scans"));
}

}  // namespace
}  // namespace plumbline
