#include "plumbline/apps/evaluation/truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// One scan of two beams, ahead and to the left, from each pose; pose p has the time p / 10 s.
SlamGraph MakeGraph(const std::vector<Pose2>& poses) {
  LaserModel laser;
  laser.num_beams = 2;
  laser.bearing_step_rad = 0.5 * kPi;
  SlamGraph graph;
  const int laser_id = graph.AddLaser(laser);
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const int pose_id = graph.AddPose(poses[p], 0.1 * p);
    graph.AddScan(pose_id, laser_id, {2.0, 3.0});
  }
  return graph;
}

// The truth that says that the map is right, but for its frame.
Truth TruthOf(const MapState& state, const Pose2& truth_from_world) {
  Truth truth;
  for (int p = 0; p < state.num_poses(); ++p) {
    truth.trajectory.push_back({0.1 * p, truth_from_world * state.WorldFromRobot(p)});
  }
  for (std::size_t r = 0; r < state.points.size() / 2; ++r) {
    const Eigen::Vector2d point(state.points[2 * r], state.points[2 * r + 1]);
    const Eigen::Vector2d moved = truth_from_world * point;
    truth.points.insert(truth.points.end(), {moved.x(), moved.y()});
  }
  return truth;
}

TEST(CompareWithTruthTest, TheWorldFrameDoesNotCount) {
  const SlamGraph graph = MakeGraph({{1, 2, 0.3}, {2, 2.5, 1.2}, {4, 1, -2.9}, {3, 0, 3.0}});
  const MapState state = graph.InitialState();
  for (const Pose2& motion : {Pose2(5, -7, 2.8), Pose2(-300, 20, -3.1), Pose2(0, 0, kPi)}) {
    const TruthError error = CompareWithTruth(graph, state, TruthOf(state, motion));
    EXPECT_NEAR(error.mean_pose_error_m, 0.0, 1e-12);
    EXPECT_NEAR(error.mean_pose_error_rad, 0.0, 1e-12);
    EXPECT_NEAR(error.mean_point_error_m, 0.0, 1e-12);
  }
}

// Four poses on the corners of a square of 2 m, the true square has 2.2 m: the best motion keeps
// the centre, and every corner is off by 0.1 sqrt(2).
TEST(CompareWithTruthTest, ErrorsWorkedByHand) {
  const SlamGraph graph = MakeGraph({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  const MapState state = graph.InitialState();
  Truth truth = TruthOf(state, Pose2());
  for (TimedPose& pose : truth.trajectory) {
    pose.world_from_robot.x *= 1.1;
    pose.world_from_robot.y *= 1.1;
  }
  truth.trajectory[0].world_from_robot.yaw = -0.2;
  truth.trajectory[2].world_from_robot.yaw = 2.0 * kPi + 0.4;
  truth.points[0] += 0.3;
  truth.points[1] += 0.4;
  const TruthError error = CompareWithTruth(graph, state, truth);
  EXPECT_NEAR(error.mean_pose_error_m, 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(error.mean_pose_error_rad, 0.6 / 4.0, 1e-12);
  EXPECT_NEAR(error.mean_point_error_m, 0.5 / 8.0, 1e-12);
}

TEST(CompareWithTruthTest, ReturnsWithoutATruePointDoNotCount) {
  const SlamGraph graph = MakeGraph({{0, 0, 0}, {1, 0, 0}});
  const MapState state = graph.InitialState();
  Truth truth = TruthOf(state, Pose2());
  truth.points = {truth.points[0] + 0.2, truth.points[1], kNaN, kNaN, kNaN, 0.0, kNaN, kNaN};
  EXPECT_NEAR(CompareWithTruth(graph, state, truth).mean_point_error_m, 0.2, 1e-12);
  truth.points.assign(8, kNaN);
  EXPECT_TRUE(std::isnan(CompareWithTruth(graph, state, truth).mean_point_error_m));
  truth.points.clear();
  EXPECT_TRUE(std::isnan(CompareWithTruth(graph, state, truth).mean_point_error_m));
}

TEST(CompareWithTruthTest, ARobotThatNeverMovesIsAlignedByItsHeading) {
  const SlamGraph graph = MakeGraph({{3, 4, 0.5}, {3, 4, 0.5}, {3, 4, 0.7}});
  const MapState state = graph.InitialState();
  const TruthError error = CompareWithTruth(graph, state, TruthOf(state, Pose2(-8, 1, 2.0)));
  EXPECT_NEAR(error.mean_pose_error_m, 0.0, 1e-12);
  EXPECT_NEAR(error.mean_pose_error_rad, 0.0, 1e-12);
  EXPECT_NEAR(error.mean_point_error_m, 0.0, 1e-12);
}

TEST(CompareWithTruthTest, AnEmptyMapHasNoError) {
  EXPECT_EQ(CompareWithTruth(SlamGraph(), MapState(), Truth()).mean_pose_error_m, 0.0);
}

class ReadTruthTest : public testing::Test {
 protected:
  // Reads the truth of a graph of two poses.
  Status Read(const std::string& trajectory, const std::string& hits) {
    WriteFile(trajectory_path_, trajectory);
    WriteFile(hits_path_, hits);
    return ReadTruth(trajectory_path_, hits_path_, MakeGraph({{0, 0, 0}, {1, 0, 0}}), &truth_);
  }

  const std::string folder_ = TempFolder();
  const std::string trajectory_path_ = folder_ + "a.tum", hits_path_ = folder_ + "a.hits";
  // Not in the graph's order, with a pose that the graph lacks, and times off by less than 1 ms.
  const std::string good_trajectory_ =
      "0.1003 5 6 0 0 0 0 1\n0.7 9 9 0 0 0 0 1\n0.000 3 4 0 0 0 1 0\n";
  Truth truth_;
};

TEST_F(ReadTruthTest, JoinsByTimeAndBeam) {
  const Status status =
      Read(good_trajectory_, "# t beam x y\n0.1 1 7 8\n\n0 0 -1.5 2.5\n0.7 0 9 9\n");
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(truth_.trajectory.size(), 2u);
  EXPECT_EQ(truth_.trajectory[0].world_from_robot.x, 3.0);
  EXPECT_NEAR(std::abs(truth_.trajectory[0].world_from_robot.yaw), kPi, 1e-12);
  EXPECT_EQ(truth_.trajectory[1].world_from_robot.y, 6.0);
  ASSERT_EQ(truth_.points.size(), 8u);
  EXPECT_EQ(truth_.points[0], -1.5);
  EXPECT_EQ(truth_.points[1], 2.5);
  for (const int i : {2, 3, 4, 5}) EXPECT_TRUE(std::isnan(truth_.points[i])) << i;
  EXPECT_EQ(truth_.points[6], 7.0);
  EXPECT_EQ(truth_.points[7], 8.0);
}

TEST_F(ReadTruthTest, AUselessClockJoinsByOrder) {
  SlamGraph graph;
  for (int p = 0; p < 3; ++p) graph.AddPose(Pose2(), 7.0);
  WriteFile(trajectory_path_, "7 1 0 0 0 0 0 1\n7 2 0 0 0 0 0 1\n7 3 0 0 0 0 0 1\n");
  ASSERT_TRUE(ReadTruth(trajectory_path_, "", graph, &truth_).ok());
  ASSERT_EQ(truth_.trajectory.size(), 3u);
  for (int p = 0; p < 3; ++p) EXPECT_EQ(truth_.trajectory[p].world_from_robot.x, p + 1.0);
  WriteFile(hits_path_, "7 0 1 2\n");
  EXPECT_THAT(ReadTruth(trajectory_path_, hits_path_, graph, &truth_).message(),
              HasSubstr(hits_path_ + ": hits find their scans by time"));
  WriteFile(trajectory_path_, "7 1 0 0 0 0 0 1\n7 2 0 0 0 0 0 1\n");
  const Status status = ReadTruth(trajectory_path_, "", graph, &truth_);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr(trajectory_path_ + ": its clock is useless"));
}

TEST_F(ReadTruthTest, HitsMayBeLeftOut) {
  WriteFile(trajectory_path_, good_trajectory_);
  ASSERT_TRUE(ReadTruth(trajectory_path_, "", MakeGraph({{0, 0, 0}}), &truth_).ok());
  EXPECT_TRUE(truth_.points.empty());
}

TEST_F(ReadTruthTest, NamesTheTimeThatHasNoPose) {
  const Status status = Read("0 0 0 0 0 0 0 1\n0.102 0 0 0 0 0 0 1\n", "");
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr(trajectory_path_ + ": no pose"));
  EXPECT_THAT(status.message(), HasSubstr("0.1000"));
}

TEST_F(ReadTruthTest, NamesFileLineAndFieldOfABadLine) {
  const auto expect_error = [this](const std::string& hits, const std::string& part) {
    const Status status = Read(good_trajectory_, hits);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr(hits_path_ + part)) << hits;
  };
  expect_error("0 0 1 2\n0 zero 1 2\n", ":2: field 'beam'");
  expect_error("0 0 1 nan\n", ":1: field 'y'");
  expect_error("0 0 1\n", ":1: field 'y'");
  expect_error("x 0 1 2\n", ":1: field 't'");
  EXPECT_FALSE(Read(good_trajectory_, "0 0 1 2 3\n").ok());
  EXPECT_THAT(Read("0 0 0 0 0 0 0 one\n", "").message(), HasSubstr(trajectory_path_ + ":1: "));
}

TEST_F(ReadTruthTest, AFailureLeavesTheTruthAsItWas) {
  truth_.points = {1.0, 2.0};
  EXPECT_FALSE(Read(good_trajectory_, "bad\n").ok());
  EXPECT_EQ(truth_.points.size(), 2u);
  EXPECT_TRUE(truth_.trajectory.empty());
}

TEST_F(ReadTruthTest, ReportsMissingFiles) {
  const SlamGraph graph = MakeGraph({{0, 0, 0}});
  EXPECT_EQ(ReadTruth(folder_ + "none", "", graph, &truth_).code(), StatusCode::kNotFound);
  WriteFile(trajectory_path_, good_trajectory_);
  EXPECT_EQ(ReadTruth(trajectory_path_, folder_ + "none", graph, &truth_).code(),
            StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
