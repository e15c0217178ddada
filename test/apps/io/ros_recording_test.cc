#include "plumbline/apps/io/ros_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "plumbline/core/angle.h"
#include "plumbline/test/apps/io/ros_recording_testing.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST_F(RosRecordingTest, ScansTakeTheirPlaceFromOdometryMessages) {
  Build();
  ExpectDrive();
  EXPECT_THAT(notes_.warnings, IsEmpty());
  EXPECT_EQ(notes_.num_skipped_scans, 0u);
  EXPECT_EQ(notes_.num_out_of_order, 0u);
  const LaserModel& laser = graph_.laser(0);
  EXPECT_EQ(laser.num_beams, 4);
  EXPECT_EQ(laser.first_bearing_rad, -0.5);
  EXPECT_EQ(laser.bearing_step_rad, 0.25);
  EXPECT_EQ(laser.min_range_m, 0.1);
  EXPECT_EQ(laser.max_range_m, 10.0);
  EXPECT_NEAR(laser.robot_from_laser.x, 0.2, 1e-12);
  EXPECT_NEAR(laser.robot_from_laser.yaw, 0.1, 1e-12);
  EXPECT_EQ(graph_.num_lasers(), 1);
}

TEST_F(RosRecordingTest, ScansTakeTheirPlaceFromTransforms) {
  MoveOdometryToTransforms();
  Build();
  ExpectDrive();
  EXPECT_NEAR(graph_.laser(0).robot_from_laser.x, 0.2, 1e-12);
  EXPECT_THAT(notes_.warnings, IsEmpty());
}

TEST_F(RosRecordingTest, TheRobotIsRightBelowTheOdometry) {
  MoveOdometryToTransforms();
  TransformTree longer = recording_.transforms;
  recording_.transforms = TransformTree();
  for (const StampedTransform& sample : longer.Samples("odom", "base")) {
    recording_.transforms.Add("odom", "footprint", sample);
  }
  recording_.transforms.Add("map", "odom", {0.0, Upright(7.0, 7.0, 1.0)});
  recording_.transforms.Add("footprint", "base", {0.0, Upright(0.05, 0.0, 0.0)});
  recording_.transforms.Add("base", "laser", {0.0, Upright(0.2, 0.0, 0.1)});
  Build();
  ExpectDrive();
  EXPECT_NEAR(graph_.laser(0).robot_from_laser.x, 0.25, 1e-12);
}

TEST_F(RosRecordingTest, ReturnsInAnyDirectionKeepIt) {
  for (RosScan& scan : recording_.scans) {
    scan.angle_increment_rad = 2.0 * kPi / 8;
    scan.angle_min_rad = -kPi;
    scan.range_max_m = kInf;
    scan.ranges = {3.0, kInf, 1.0, 2.0};
    scan.bearings_rad = {2.5, 0.0, -1.25, 0.125};
  }
  for (const BeamDirection direction :
       {BeamDirection::kStated, BeamDirection::kReversed, BeamDirection::kUpsideDown}) {
    for (const bool upside_down : {false, true}) {
      PutLaser(Rolled(Upright(0.2, 0.0, 0.1), upside_down ? 180.0 : 0.0));
      options_.beam_direction = direction;
      Build();
      EXPECT_THAT(notes_.warnings, IsEmpty());
      EXPECT_EQ(graph_.laser(0).num_beams, 8);
      ASSERT_EQ(graph_.num_returns(), 9u);
      const bool is_mirrored = upside_down != (direction != BeamDirection::kStated);
      for (std::size_t i = 0; i < 3; ++i) {  // each of the first scan, in whichever order
        const double bearing_rad = graph_.Bearing(i);
        const float range_m = graph_.returns().range_m[i];
        const double expected_rad = range_m == 3.0f ? 2.5 : range_m == 1.0f ? -1.25 : 0.125;
        EXPECT_NEAR(bearing_rad, is_mirrored ? -expected_rad : expected_rad, 1e-6) << range_m;
      }
    }
  }
}

TEST_F(RosRecordingTest, ALaserUpsideDownSeesLeftAndRightExchanged) {
  PutLaser(Rolled(Upright(0.2, 0.0, 0.1), 180.0));
  Build();
  const LaserModel& laser = graph_.laser(0);
  EXPECT_EQ(laser.first_bearing_rad, 0.5);
  EXPECT_EQ(laser.bearing_step_rad, -0.25);
  // By hand: the first beam's end in the laser's frame, taken through the transform.
  const Eigen::Vector3d end =
      Rolled(Upright(0.2, 0.0, 0.1), 180.0) * Eigen::Vector3d(std::cos(-0.5), std::sin(-0.5), 0.0);
  const std::vector<int> beams = graph_.Beams();
  const auto first = std::find(beams.begin(), beams.end(), 0);
  const Eigen::Vector2d point = graph_.PointInRobot(first - beams.begin());
  EXPECT_NEAR(point.x(), end.x(), 1e-12);
  EXPECT_NEAR(point.y(), end.y(), 1e-12);
}

TEST_F(RosRecordingTest, ATiltedLaserIsRefused) {
  PutLaser(Rolled(Upright(0.2, 0.0, 0.1), 2.0));
  Build();
  EXPECT_EQ(graph_.num_scans(), 3);
  graph_ = SlamGraph();
  PutLaser(Rolled(Upright(0.2, 0.0, 0.1), 12.0));
  EXPECT_THAT(Failure(), AllOf(HasSubstr("a.bag: "), HasSubstr("'laser' is tilted by 12.0"),
                               HasSubstr("'base'")));
}

TEST_F(RosRecordingTest, AMovingLaserIsRefused) {
  recording_.transforms.Add("base", "laser", {100.2, Upright(0.2, 0.0, 0.1)});
  recording_.transforms.Add("base", "laser", {100.3, Upright(0.2, 0.0, 0.15)});
  EXPECT_THAT(Failure(),
              AllOf(HasSubstr("a.bag: 2 of 3 messages on /scan cannot be used: the laser has moved "
                              "on the robot (2)"),
                    HasSubstr("/scan message 1 (100.250000 s): the laser's frame 'laser' has "
                              "moved on the robot, 'base'")));
}

TEST_F(RosRecordingTest, AnUnknownMountingIsSaidAndTakenAsTheCentre) {
  recording_.transforms = TransformTree();
  Build();
  ExpectDrive();
  EXPECT_EQ(graph_.laser(0).robot_from_laser.x, 0.0);
  ExpectWarning("unknown_mounting", AllOf(HasSubstr("a.bag"), HasSubstr("'base'"),
                                          HasSubstr("'laser'"), HasSubstr("centre")));
}

TEST_F(RosRecordingTest, WhatIsNoReadingIsNoReturn) {
  recording_.scans.resize(1);
  recording_.scans[0].ranges = {kNan, kInf, -kInf, 0.0, 0.099, 0.1, 9.999, 10.0, 11.0, -1.0};
  Build();
  EXPECT_THAT(graph_.returns().range_m, ElementsAre(0.1, 9.999));
  EXPECT_THAT(graph_.Beams(), ElementsAre(5, 6));
}

TEST_F(RosRecordingTest, LimitsThatTheDriverDoesNotKnowAreTheUsualOnes) {
  recording_.scans.resize(1);
  recording_.scans[0].range_min_m = 0.0;
  recording_.scans[0].range_max_m = kInf;
  recording_.scans[0].ranges = {0.0, 0.06, 79.0, kInf};
  Build();
  EXPECT_THAT(graph_.returns().range_m, ElementsAre(0.06, 79.0));
}

TEST_F(RosRecordingTest, ASweepMayRunClockwise) {
  for (RosScan& scan : recording_.scans) scan.angle_increment_rad = -0.25;
  Build();
  EXPECT_EQ(graph_.laser(0).bearing_step_rad, -0.25);
  EXPECT_NEAR(graph_.Bearing(1), -0.75, 1e-12);
}

TEST_F(RosRecordingTest, BeamsAreTheMedianOfTheTimeIncrementsApart) {
  const auto period_s = [this](double first, double second, double third) {
    recording_.scans[0].time_increment_s = first;
    recording_.scans[1].time_increment_s = second;
    recording_.scans[2].time_increment_s = third;
    Build();
    EXPECT_EQ(graph_.num_lasers(), 1);
    return graph_.laser(0).beam_period_s;
  };
  EXPECT_EQ(period_s(0.01, 0.012, 0.011), 0.011);
  EXPECT_EQ(period_s(0.0, 0.0, 0.01), 0.0);
  // No sweep at all, or one that takes minutes.
  EXPECT_EQ(period_s(-0.01, -0.01, -0.01), 0.0);
  EXPECT_EQ(period_s(20.0, 20.0, 20.0), 0.0);
  EXPECT_EQ(period_s(std::nan(""), std::nan(""), 0.01), 0.0);
  options_.sweep_time_s = 0.08;
  EXPECT_EQ(period_s(0.01, 0.01, 0.01), 0.02);
}

TEST_F(RosRecordingTest, FewScansWithoutOdometryAreLeftOutAndNamed) {
  for (int i = 0; i < 160; ++i) recording_.scans.push_back(Scan(100.4 + 0.0005 * (i + 1)));
  recording_.scans.push_back(Scan(100.51));  // after the last
  recording_.scans.push_back(Scan(101.5));   // in a gap of 2 s
  recording_.odometry.push_back({102.6, {5.0, 2.6, DegToRad(90.0)}});
  Build();
  EXPECT_EQ(graph_.num_poses(), 163);
  EXPECT_EQ(notes_.num_skipped_scans, 2u);
  EXPECT_THAT(
      notes_.skipped_scans,
      ElementsAre("a.bag: /scan message 163 (100.510000 s): no odometry before and after it",
                  "a.bag: /scan message 164 (101.500000 s): no odometry before and after it"));
}

TEST_F(RosRecordingTest, SlowOdometryIsInterpolated) {
  recording_.odometry = {{100.0, {5.0, 0.0, DegToRad(90.0)}}, {101.0, {5.0, 1.0, DegToRad(90.0)}}};
  Build();
  ExpectDrive();
  ExpectWarning("sparse_odometry",
                AllOf(HasSubstr("100.0 % of the scans have no odometry within 0.5"),
                      HasSubstr("3 lie between messages that are further apart, and 0 are")));
}

TEST_F(RosRecordingTest, ScansBeforeAndAfterTheOdometryKeepItsEnds) {
  recording_.scans.insert(recording_.scans.begin(), Scan(99.9));
  recording_.scans.push_back(Scan(102.0));
  // A leap of 9 m tells nothing of the way there.
  recording_.odometry.push_back({103.0, {5.0, 9.5, DegToRad(90.0)}});
  Build();
  ASSERT_EQ(graph_.num_poses(), 5);
  EXPECT_EQ(graph_.InitialPose(0).x, 0.0);
  EXPECT_NEAR(graph_.InitialPose(1).x, 0.05, 1e-9);
  EXPECT_NEAR(graph_.InitialPose(3).x, 0.4, 1e-9);
  EXPECT_NEAR(graph_.InitialPose(4).x, 9.5, 1e-9);
  ASSERT_EQ(graph_.odometry().size(), 4u);
  EXPECT_FALSE(graph_.odometry()[0].is_measured);
  EXPECT_TRUE(graph_.odometry()[1].is_measured);
  EXPECT_FALSE(graph_.odometry()[3].is_measured);
  ExpectWarning("sparse_odometry", HasSubstr("0 lie between messages that are further apart, and "
                                             "2 are matched without odometry"));
}

TEST_F(RosRecordingTest, WithoutAnyScanInTheOdometryThereIsNoGraph) {
  for (RosScan& scan : recording_.scans) scan.stamp_s += 100.0;
  EXPECT_THAT(Failure(), AllOf(HasSubstr("no scan has odometry"), HasSubstr("/odom")));
}

TEST_F(RosRecordingTest, LateMessagesAreSortedIn) {
  std::swap(recording_.scans[1], recording_.scans[2]);
  std::swap(recording_.odometry[1], recording_.odometry[2]);
  Build();
  std::swap(recording_.scans[1], recording_.scans[2]);
  ExpectDrive();
  EXPECT_EQ(notes_.num_out_of_order, 2u);
}

TEST_F(RosRecordingTest, AClockThatStandsStillIsAnError) {
  for (RosScan& scan : recording_.scans) scan.stamp_s = 100.2;
  for (int i = 0; i < 3; ++i) recording_.scans[i].ranges[0] += i;
  EXPECT_THAT(Failure(),
              HasSubstr("a.bag: /scan: its clock is useless: 1 different time for 3 entries"));
  recording_.scans.resize(1);
  for (TimedPose& pose : recording_.odometry) pose.timestamp_s = 100.2;
  EXPECT_THAT(Failure(), HasSubstr("a.bag: /odom: its clock is useless"));
}

TEST_F(RosRecordingTest, AClockThatJumpsBackIsAnError) {
  recording_.scans.push_back(Scan(95.0));
  EXPECT_THAT(Failure(), AllOf(HasSubstr("/scan message 3 (95.000000 s): the clock jumps back by "
                                         "5.4"),
                               HasSubstr("cut the recording there")));
  recording_.scans.pop_back();
  recording_.odometry.push_back({20.0, {}});
  EXPECT_THAT(Failure(), HasSubstr("/odom message 6 (20.000000 s): the clock jumps back"));
}

// Ahead, odometry and scans jump together, and nothing is lost but the scan in between.
TEST_F(RosRecordingTest, AClockMayJumpAhead) {
  for (int i = 0; i < 3; ++i) {
    recording_.odometry.push_back({5000.0 + 0.1 * i, {5.0, 0.6 + 0.1 * i, DegToRad(90.0)}});
  }
  recording_.scans.push_back(Scan(5000.1));
  Build();
  ASSERT_EQ(graph_.num_poses(), 4);
  EXPECT_NEAR(graph_.InitialPose(3).x, 0.65, 1e-9);
}

TEST_F(RosRecordingTest, WithoutOdometryEveryScanBecomesAPose) {
  recording_.odom_topic.clear();
  recording_.odometry.clear();
  Build();
  EXPECT_EQ(graph_.num_poses(), 3);
  EXPECT_EQ(graph_.num_scans(), 3);
  EXPECT_TRUE(graph_.odometry().empty());
  EXPECT_NEAR(graph_.laser(0).robot_from_laser.x, 0.2, 1e-12);
  EXPECT_THAT(notes_.warnings, IsEmpty());
}

TEST_F(RosRecordingTest, WithoutOdometryAndTransformsTheRobotIsTheLaser) {
  recording_.odom_topic.clear();
  recording_.odometry.clear();
  recording_.transforms = TransformTree();
  Build();
  EXPECT_EQ(graph_.laser(0).robot_from_laser.x, 0.0);
  EXPECT_THAT(notes_.warnings, IsEmpty());
}

TEST_F(RosRecordingTest, WithoutOdometryTheRobotIsAsFarUpAsNothingMoves) {
  recording_.odom_topic.clear();
  recording_.odometry.clear();
  recording_.transforms.Add("footprint", "base", {0.0, Upright(0.1, 0.0, 0.0)});
  for (int i = 0; i < 6; ++i) {
    recording_.transforms.Add("map", "footprint", {100.0 + 0.1 * i, Upright(0.1 * i, 0.0, 0.0)});
  }
  Build();
  EXPECT_TRUE(graph_.odometry().empty());
  EXPECT_NEAR(graph_.laser(0).robot_from_laser.x, 0.3, 1e-12);
  ExpectWarning("unused_transforms",
                HasSubstr("'footprint' moves in 'map': --odom_frame=map takes that"));
}

TEST_F(RosRecordingTest, OdometryThatNeverChangesIsNone) {
  for (TimedPose& pose : recording_.odometry) pose.world_from_robot = {5.0, 1.0, 0.3};
  recording_.needs_odometry = true;
  Build();
  EXPECT_EQ(graph_.num_poses(), 3);
  EXPECT_TRUE(graph_.odometry().empty());
}

TEST_F(RosRecordingTest, ATopicThatWasAskedForNeedsMessages) {
  recording_.odometry.clear();
  recording_.needs_odometry = true;
  EXPECT_THAT(Failure(), HasSubstr("there is no message on /odom"));
}

TEST_F(RosRecordingTest, WithoutTheOdometryThatWasAskedForTheFramesAreNamed) {
  recording_.odom_topic.clear();
  recording_.odometry.clear();
  recording_.needs_odometry = true;
  EXPECT_THAT(Failure(), AllOf(HasSubstr("no frame 'odom' above the laser's, 'laser'"),
                               HasSubstr("frames: base, laser")));
}

TEST_F(RosRecordingTest, OneBadScanIsSkippedAndNamedWithItsField) {
  const struct {
    std::function<void(RosScan*)> spoil;
    std::string message;
  } kCases[] = {
      {[](RosScan* s) { s->stamp_s = 0.0; }, "field 'header.stamp'"},
      {[](RosScan* s) { s->ranges.clear(); }, "field 'ranges' is empty"},
      {[](RosScan* s) { s->angle_min_rad = kNan; }, "field 'angle_min'"},
      {[](RosScan* s) { s->angle_increment_rad = 0.0; }, "field 'angle_increment'"},
      {[](RosScan* s) { s->range_max_m = 0.0; }, "field 'range_max'"},
      {[](RosScan* s) { s->range_max_m = 0.05; }, "field 'range_max'"},
      {[](RosScan* s) { s->range_min_m = kNan; }, "field 'range_min'"},
      {[](RosScan* s) { s->frame = "other"; }, "field 'header.frame_id' is 'other', but 'laser'"},
      {[](RosScan* s) { s->fault = "field 'ranges': cut off"; }, "field 'ranges': cut off"},
      {[](RosScan* s) { s->angle_min_rad = 100.0; }, "first_bearing_rad"},
  };
  while (recording_.scans.size() < 12) recording_.scans.push_back(Scan(100.4));
  for (int i = 0; i < 12; ++i) recording_.scans[i].stamp_s = 100.02 + 0.03 * i;
  const std::vector<RosScan> sound = recording_.scans;
  for (const auto& c : kCases) {
    recording_.scans = sound;
    c.spoil(&recording_.scans[1]);
    Build();
    EXPECT_EQ(graph_.num_scans(), 11);
    EXPECT_EQ(notes_.num_skipped_scans, 1u);
    EXPECT_THAT(notes_.skipped_scans,
                ElementsAre(AllOf(HasSubstr("a.bag: /scan message 1 ("), HasSubstr(c.message))));
    ExpectWarning("bad_messages", AllOf(HasSubstr("1 of 12 messages on /scan cannot be used: "),
                                        HasSubstr(c.message)));
    // More than half of them are no accident.
    for (int i = 0; i < 8; ++i) c.spoil(&recording_.scans[i]);
    graph_ = SlamGraph();
    // Then it is not stated, or the scans repeat each other.
    if (c.message == "field 'range_max'" || c.message == "field 'header.stamp'") continue;
    EXPECT_NE(BuildGraph(recording_, options_, 0, &notes_, &graph_).code(), StatusCode::kOk)
        << c.message;
  }
}

TEST_F(RosRecordingTest, MoreBadScansThanAllowedAreRefused) {
  while (recording_.scans.size() < 100) recording_.scans.push_back(Scan(100.0));
  for (int i = 0; i < 100; ++i) {
    recording_.scans[i].stamp_s = 100.0 + 0.005 * i;
    if (i % 9 == 0) recording_.scans[i].ranges.clear();
  }
  EXPECT_THAT(Failure(), HasSubstr("12 of 100 messages on /scan cannot be used: field 'ranges' is "
                                   "empty (12); the first one: /scan message 0 (100.000000 s)"));
}

TEST_F(RosRecordingTest, BadOdometryIsToldOrRefused) {
  recording_.bad_odometry.Add("field 'pose.pose' is not finite", "/odom message 0: not finite");
  Build();
  ExpectDrive();
  ExpectWarning("bad_messages", HasSubstr("1 of 7 messages on /odom cannot be used: field "
                                          "'pose.pose' is not finite (1)"));
  for (int i = 0; i < 10; ++i) recording_.bad_odometry.Add("no pose", "another");
  graph_ = SlamGraph();
  EXPECT_THAT(Failure(), HasSubstr("11 of 17 messages on /odom cannot be used"));
}

TEST_F(RosRecordingTest, AScanWhileTheLaserIsTiltedIsSkipped) {
  recording_.transforms = TransformTree();
  for (const double stamp_s : {100.0, 100.2, 100.25, 100.3}) {
    recording_.transforms.Add(
        "base", "laser", {stamp_s, Rolled(Upright(0.2, 0.0, 0.1), stamp_s == 100.25 ? 8.0 : 0.0)});
  }
  Build();
  EXPECT_EQ(graph_.num_scans(), 2);
  ExpectWarning("bad_messages", HasSubstr("the laser is tilted (1); the first one: /scan message 1 "
                                          "(100.250000 s)"));
}

TEST_F(RosRecordingTest, ARepeatedScanIsDropped) {
  const std::vector<RosScan> scans = recording_.scans;
  recording_.scans.clear();
  for (const RosScan& scan : scans) recording_.scans.insert(recording_.scans.end(), 3, scan);
  Build();
  recording_.scans = scans;
  ExpectDrive();
  ExpectWarning("repeated_scans", HasSubstr("6 of 9 messages on /scan repeat the one before"));
}

TEST_F(RosRecordingTest, ARangeMaxOfZeroInAllScansIsNotStated) {
  for (RosScan& scan : recording_.scans) {
    scan.range_max_m = 0.0;
    scan.ranges = {1.0, 79.0, kInf, 81.0};
  }
  Build();
  EXPECT_THAT(graph_.Beams(), ElementsAre(0, 1, 0, 1, 0, 1));
  EXPECT_THAT(notes_.warnings, IsEmpty());
}

TEST_F(RosRecordingTest, SeveralLasersAreAChoiceOfTheUser) {
  recording_.scans[1].frame = "rear";
  const Status status = BuildGraph(recording_, options_, 0, &notes_, &graph_);
  EXPECT_THAT(status.message(), AllOf(HasSubstr("several lasers share /scan: choose one by "
                                                "--laser_frame"),
                                      HasSubstr("'laser' (2 scans), 'rear' (1 scans)")));
  options_.laser_frame = "laser";
  Build();
  EXPECT_EQ(graph_.num_scans(), 2);
  EXPECT_THAT(notes_.warnings, IsEmpty());
  options_.laser_frame = "front";
  EXPECT_THAT(BuildGraph(recording_, options_, 0, &notes_, &graph_).message(),
              HasSubstr("no scan on /scan is of the frame 'front'"));
}

TEST_F(RosRecordingTest, OdometryCountsWhereNoTransformKnowsTheLaser) {
  MoveOdometryToTransforms();
  for (RosScan& scan : recording_.scans) scan.frame = "stranger";
  Build();
  ExpectDrive();
  EXPECT_EQ(graph_.laser(0).robot_from_laser.x, 0.0);
  ExpectWarning("unknown_mounting", AllOf(HasSubstr("'base'"), HasSubstr("'stranger'")));
}

TEST_F(RosRecordingTest, AngleMaxDecidesWhatTheIncrementLeavesOpen) {
  const auto bearings = [this](double min, double max, double increment) {
    for (RosScan& scan : recording_.scans) {
      scan.angle_min_rad = min;
      scan.angle_max_rad = max;
      scan.angle_increment_rad = increment;
    }
    Build();
    return std::make_pair(graph_.laser(0).first_bearing_rad, graph_.laser(0).bearing_step_rad);
  };
  EXPECT_EQ(bearings(-0.5, 0.25, 0.25), std::make_pair(-0.5, 0.25));
  EXPECT_EQ(bearings(-0.5, 0.5, 0.25), std::make_pair(-0.5, 0.25));             // one step more
  EXPECT_EQ(bearings(-0.5, 0.0, 0.3), std::make_pair(-0.5, 0.3));               // not stated
  EXPECT_EQ(bearings(3.0, 3.75 - 2.0 * kPi, 0.25), std::make_pair(3.0, 0.25));  // within a turn
  EXPECT_THAT(notes_.warnings, IsEmpty());
  EXPECT_EQ(bearings(0.5, -0.25, 0.0), std::make_pair(0.5, -0.25));
  EXPECT_THAT(notes_.warnings, IsEmpty());
  EXPECT_EQ(bearings(0.5, -0.25, 0.25), std::make_pair(0.5, -0.25));
  ExpectWarning("beam_angles_contradict",
                AllOf(HasSubstr("3 of 3 scans on /scan contradict themselves: 4 readings from "
                                "angle_min = 0.5 rad"),
                      HasSubstr("angle_max is believed (--beam_direction")));
  EXPECT_TRUE(notes_.angles_contradict);
  EXPECT_EQ(bearings(-0.75, 0.75, 0.125), std::make_pair(-0.75, 0.5));
  options_.angle_source = BeamAngleSource::kIncrement;
  EXPECT_EQ(bearings(0.5, -0.25, 0.25), std::make_pair(0.5, 0.25));
}

TEST_F(RosRecordingTest, TheBeamsCanBeTurnedRound) {
  options_.beam_direction = BeamDirection::kReversed;
  Build();
  EXPECT_EQ(graph_.laser(0).first_bearing_rad, 0.25);
  EXPECT_EQ(graph_.laser(0).bearing_step_rad, -0.25);
  options_.beam_direction = BeamDirection::kUpsideDown;
  Build();
  EXPECT_EQ(graph_.laser(0).first_bearing_rad, 0.5);
  EXPECT_EQ(graph_.laser(0).bearing_step_rad, -0.25);
}

TEST_F(RosRecordingTest, MaxScansTakesTheFirst) {
  Build(2);
  EXPECT_EQ(graph_.num_scans(), 2);
  EXPECT_THAT(BuildGraph(recording_, RosGraphOptions(), -1, &notes_, &graph_).message(),
              HasSubstr("max_scans = -1"));
  RosGraphOptions options;
  options.max_gap_s = 0.0;
  EXPECT_THAT(BuildGraph(recording_, options, 0, &notes_, &graph_).message(),
              HasSubstr("max_gap_s = 0"));
  recording_.scans.clear();
  EXPECT_THAT(BuildGraph(recording_, RosGraphOptions(), 0, &notes_, &graph_).message(),
              HasSubstr("no message on /scan"));
}

}  // namespace
}  // namespace plumbline
