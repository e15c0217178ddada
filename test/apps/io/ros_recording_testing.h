#ifndef PLUMBLINE_TEST_APPS_IO_ROS_RECORDING_TESTING_H_
#define PLUMBLINE_TEST_APPS_IO_ROS_RECORDING_TESTING_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/core/angle.h"

namespace plumbline {

inline Eigen::Isometry3d Upright(double x, double y, double yaw) {
  return Eigen::Translation3d(x, y, 0.3) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
}
inline Eigen::Isometry3d Rolled(const Eigen::Isometry3d& transform, double roll_deg) {
  return transform * Eigen::AngleAxisd(DegToRad(roll_deg), Eigen::Vector3d::UnitX());
}

inline RosScan Scan(double stamp_s) {
  RosScan scan;
  scan.stamp_s = stamp_s;
  scan.frame = "laser";
  scan.angle_min_rad = -0.5;
  scan.angle_increment_rad = 0.25;
  scan.range_min_m = 0.1;
  scan.range_max_m = 10.0;
  scan.ranges = {1.0, 2.0, 3.0, 4.0};
  return scan;
}

// A robot that drives 1 m/s along the y axis of its odometry, from t = 100 s on; its laser sits
// 0.2 m ahead, turned by 0.1 rad.
class RosRecordingTest : public testing::Test {
 protected:
  RosRecordingTest() {
    recording_.path = "a.bag";
    recording_.scan_topic = "/scan";
    for (const double stamp_s : {100.05, 100.25, 100.4}) recording_.scans.push_back(Scan(stamp_s));
    recording_.odom_topic = "/odom";
    recording_.robot_frame = "base";
    for (int i = 0; i < 6; ++i) {
      recording_.odometry.push_back({100.0 + 0.1 * i, {5.0, 0.1 * i, DegToRad(90.0)}});
    }
    recording_.transforms.Add("base", "laser", {0.0, Upright(0.2, 0.0, 0.1)});
  }

  // The same odometry as transforms.
  void MoveOdometryToTransforms() {
    recording_.odom_topic.clear();
    recording_.robot_frame.clear();
    for (const TimedPose& pose : recording_.odometry) {
      recording_.transforms.Add(
          "odom", "base",
          {pose.timestamp_s,
           Upright(pose.world_from_robot.x, pose.world_from_robot.y, pose.world_from_robot.yaw)});
    }
    recording_.odometry.clear();
  }
  void PutLaser(const Eigen::Isometry3d& robot_from_laser) {
    recording_.transforms = TransformTree();
    recording_.transforms.Add("base", "laser", {0.0, robot_from_laser});
  }

  void Build(int max_scans = 0) {
    const Status status = BuildGraph(recording_, options_, max_scans, &notes_, &graph_);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  std::string Failure() {
    const Status status = BuildGraph(recording_, RosGraphOptions(), 0, &notes_, &graph_);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(graph_.num_poses(), 0);
    return status.message();
  }
  // The only warning.
  void ExpectWarning(const std::string& id, const testing::Matcher<std::string>& message) const {
    ASSERT_EQ(notes_.warnings.size(), 1u);
    EXPECT_EQ(notes_.warnings[0].id, id);
    EXPECT_THAT(notes_.warnings[0].message, message);
  }
  void ExpectDrive() const {
    ASSERT_EQ(graph_.num_poses(), 3);
    const double ahead_m[] = {0.0, 0.2, 0.35};
    for (int i = 0; i < 3; ++i) {
      const Pose2 pose = graph_.InitialPose(i);
      EXPECT_NEAR(pose.x, ahead_m[i], 1e-9);
      EXPECT_NEAR(pose.y, 0.0, 1e-9);
      EXPECT_NEAR(pose.yaw, 0.0, 1e-9);
      EXPECT_EQ(graph_.timestamp_s(i), recording_.scans[i].stamp_s);
    }
    ASSERT_EQ(graph_.odometry().size(), 2u);
    EXPECT_NEAR(graph_.odometry()[1].from_from_to.x, 0.15, 1e-9);
  }

  RosRecording recording_;
  RosGraphOptions options_;
  RosGraphNotes notes_;
  SlamGraph graph_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_IO_ROS_RECORDING_TESTING_H_
