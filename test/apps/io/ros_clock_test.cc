#include "plumbline/apps/io/ros_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/apps/io/ros_recording_testing.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// The times of recording, which tests give here, are a little later than the stamps.
class RecordClockTest : public RosRecordingTest {
 protected:
  RecordClockTest() {
    for (RosScan& scan : recording_.scans) scan.received_s = scan.stamp_s;
    for (const TimedPose& pose : recording_.odometry) {
      recording_.odometry_received_s.push_back(pose.timestamp_s);
    }
    for (int i = 0; i < 3; ++i) recording_.scans[i].ranges[0] += 0.1 * i;
    stamps_s_ = {100.05, 100.25, 100.4};
  }

  // The drive by the times of recording, and why.
  void ExpectRecordClock(const std::string& why) {
    Build();
    for (int i = 0; i < 3; ++i) recording_.scans[i].stamp_s = stamps_s_[i];
    ExpectDrive();
    ExpectWarning("record_clock", AllOf(HasSubstr(why), HasSubstr("as with --clock=record")));
  }

  std::vector<double> stamps_s_;
};

TEST_F(RecordClockTest, TakesThePlaceOfStampsThatAreNotSet) {
  for (RosScan& scan : recording_.scans) scan.stamp_s = 0.0;
  ExpectRecordClock("/scan: the stamps of 3 of 3 headers are not set");
}

TEST_F(RecordClockTest, TakesThePlaceOfAClockSinceBoot) {
  for (RosScan& scan : recording_.scans) scan.stamp_s -= 90.0;
  ExpectRecordClock("the stamps on /scan and /odom are of different times");
}

TEST_F(RecordClockTest, TakesThePlaceOfWholeSeconds) {
  for (RosScan& scan : recording_.scans) scan.stamp_s = std::floor(scan.stamp_s);
  for (TimedPose& pose : recording_.odometry) pose.timestamp_s = std::floor(pose.timestamp_s);
  ExpectRecordClock("/scan: its clock is useless");
}

TEST_F(RecordClockTest, TakesThePlaceOfTheStampsOfTransforms) {
  recording_.odom_topic.clear();
  recording_.robot_frame.clear();
  for (const TimedPose& pose : recording_.odometry) {
    recording_.transforms.Add(
        "odom", "base",
        {0.0, Upright(5.0, pose.world_from_robot.y, DegToRad(90.0)), pose.timestamp_s});
  }
  recording_.odometry.clear();
  recording_.odometry_received_s.clear();
  ExpectRecordClock("headers are not set");
}

TEST_F(RecordClockTest, IsTakenOnDemandAndNotWithoutTimes) {
  options_.clock = RosClock::kRecord;
  for (RosScan& scan : recording_.scans) scan.received_s += 0.01;
  Build();
  EXPECT_NEAR(graph_.timestamp_s(0), 100.06, 1e-9);
  EXPECT_THAT(notes_.warnings, IsEmpty());
  recording_.scans[1].received_s = 0.0;
  graph_ = SlamGraph();
  EXPECT_THAT(BuildGraph(recording_, options_, 0, &notes_, &graph_).message(),
              HasSubstr("/scan: the times of recording, which --clock=record asks for, are not"));
  options_.clock = RosClock::kHeader;
  for (RosScan& scan : recording_.scans) scan.stamp_s = 100.2;
  EXPECT_THAT(BuildGraph(recording_, options_, 0, &notes_, &graph_).message(),
              HasSubstr("its clock is useless"));
}

TEST_F(RecordClockTest, OneStampThatDoesNotFitIsSkipped) {
  for (int i = 0; i < 4; ++i) {
    recording_.scans.push_back(Scan(100.41 + 0.01 * i));
    recording_.scans.back().received_s = recording_.scans.back().stamp_s;
  }
  recording_.scans[4].stamp_s = 7.0;
  Build();
  EXPECT_EQ(graph_.num_scans(), 6);
  ExpectWarning("bad_messages", HasSubstr("field 'header.stamp' does not fit the time of recording "
                                          "(1); the first one: /scan message 4 (7.000000 s)"));
}

}  // namespace
}  // namespace plumbline
