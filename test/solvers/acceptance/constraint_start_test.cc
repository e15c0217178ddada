#include "plumbline/solvers/acceptance/constraint_start.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kNumPoses = 24;

NoisyRoom Room() {
  NoisyRoomOptions options;
  options.num_poses = kNumPoses;
  return MakeNoisyRoom(options);
}

double WorstError(const std::vector<double>& poses, const std::vector<Pose2>& truth) {
  double worst_m = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    worst_m =
        std::max(worst_m, (Pose2(&poses[3 * i]).translation() - truth[i].translation()).norm());
  }
  return worst_m;
}

void SwapPoses(int a, int b, MapState* state) {
  const Pose2 pose = state->WorldFromRobot(a);
  state->SetPose(a, state->WorldFromRobot(b));
  state->SetPose(b, pose);
}

void Shuffle(const SlamGraph& graph, MapState* state) {
  for (int i = 1; i + 7 < kNumPoses; i += 3) SwapPoses(i, i + 7, state);
  state->points = graph.MeasuredMap(state->poses);
}

std::vector<Pose2> Motions(const SlamGraph& graph) {
  std::vector<Pose2> motions;
  for (const OdometryConstraint& c : graph.odometry()) motions.push_back(c.from_from_to);
  return motions;
}

TEST(ConstraintStartTest, StepsThatAgreeWithThePosesSuggestNothing) {
  NoisyRoom room = Room();
  EXPECT_FALSE(StartFromConstraints(room.graph, room.state.poses, MotionOptions()));
  DisturbPoses(0.005, room.graph, &room.state);
  EXPECT_FALSE(StartFromConstraints(room.graph, room.state.poses, MotionOptions()));
}

// A robot that was carried once: that step says nothing against all others, however far it is off.
TEST(ConstraintStartTest, OneStepThatIsFlatlyContradictedSuggestsNothing) {
  NoisyRoomOptions options;
  options.num_poses = 60;
  NoisyRoom room = MakeNoisyRoom(options);
  std::vector<Pose2> motions = Motions(room.graph);
  motions[20].x += 50.0;
  room.graph = room.graph.Corrected({motions, {}, {}, {}, {}});
  EXPECT_FALSE(StartFromConstraints(room.graph, room.state.poses, MotionOptions()));
}

TEST(ConstraintStartTest, PosesThatWereMixedUpAreSorted) {
  NoisyRoom room = Room();
  Shuffle(room.graph, &room.state);
  ASSERT_GT(WorstError(room.state.poses, room.truth), 0.2);
  const auto start = StartFromConstraints(room.graph, room.state.poses, MotionOptions());
  ASSERT_TRUE(start);
  EXPECT_LT(WorstError(*start, room.truth), 0.1);
}

TEST(ConstraintStartTest, AWrongClosureIsDownweighted) {
  NoisyRoom room = Room();
  Shuffle(room.graph, &room.state);
  const Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  room.graph.AddRelativePose({2, kNumPoses - 2, Pose2(50.0, 50.0, 1.0), covariance});
  const auto start = StartFromConstraints(room.graph, room.state.poses, MotionOptions());
  ASSERT_TRUE(start);
  EXPECT_LT(WorstError(*start, room.truth), 1.0);  // believed, it would pull by tens of metres
}

// The state is at the optimum of all edges, and no step is off it by much.
TEST(ConstraintStartTest, WhatTheScansSayTakesThePlaceOfAContradictedEdge) {
  NoisyRoom room = Room();
  EXPECT_FALSE(StartFromConstraints(room.graph, room.state.poses, MotionOptions(), {}));
  const Eigen::Matrix3d covariance = 1e-6 * Eigen::Matrix3d::Identity();
  const Pose2 right = Between(room.truth[2], room.truth[20]);
  room.graph.AddRelativePose({2, 20, right * Pose2(0.5, 0.0, 0.0), covariance});
  const std::size_t edge = room.graph.relative_poses().size() - 1;
  const auto off_m = [&](const std::vector<double>& poses) {
    return Between(Between(Pose2(&poses[6]), Pose2(&poses[3 * 20])), right).translation().norm();
  };
  const auto without =
      StartFromConstraints(room.graph, room.state.poses, MotionOptions(), {{edge, std::nullopt}});
  ASSERT_TRUE(without);
  EXPECT_LT(off_m(*without), 0.2);  // by what odometry knows
  const auto with_match =
      StartFromConstraints(room.graph, room.state.poses, MotionOptions(),
                           {{edge, RelativePoseConstraint{2, 20, right, covariance}}});
  ASSERT_TRUE(with_match);
  EXPECT_LT(off_m(*with_match), 0.005);
}

TEST(ConstraintStartTest, FixedPosesStay) {
  NoisyRoom room = Room();
  Shuffle(room.graph, &room.state);
  room.graph.FixPose(2, room.state.WorldFromRobot(2));
  const auto start = StartFromConstraints(room.graph, room.state.poses, MotionOptions());
  ASSERT_TRUE(start);
  for (int i = 0; i < 3; ++i) EXPECT_EQ((*start)[6 + i], room.state.poses[6 + i]);
}

TEST(ConstraintStartTest, WithoutAStepToEveryPoseNothingIsSuggested) {
  NoisyRoom room = Room();
  SlamGraph gap;
  gap.AddLaser(room.graph.laser(0));
  for (const double x : {0.0, 9.0, -9.0, 1.0}) gap.AddPose(Pose2(x, 0, 0), x);
  gap.AddOdometry({0, 1, Pose2(0.1, 0, 0)});
  gap.AddOdometry({2, 3, Pose2(0.1, 0, 0)});
  EXPECT_FALSE(StartFromConstraints(gap, gap.initial_poses(), MotionOptions()));
}

class SolveFromConstraints : public testing::TestWithParam<SolverType> {};
INSTANTIATE_TEST_SUITE_P(JointSolvers, SolveFromConstraints,
                         testing::Values(SolverType::kReduced, SolverType::kAlternatingCg,
                                         SolverType::kCeres),
                         [](const testing::TestParamInfo<SolverType>& info) {
                           return std::string(ToString(info.param));
                         });

TEST_P(SolveFromConstraints, BringsMixedUpPosesHome) {
  NoisyRoom room = Room();
  Shuffle(room.graph, &room.state);
  SolverOptions options;
  options.type = GetParam();
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  ASSERT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_TRUE(summary.started_from_constraints);
  EXPECT_THAT(summary.message, HasSubstr("started from odometry and relative poses"));
  EXPECT_LT(WorstError(room.state.poses, room.truth), 0.05);
}

TEST_P(SolveFromConstraints, ScansThatContradictTheOdometryKeepTheirStart) {
  // Every step turns by six standard deviations too much.
  NoisyRoom room = Room();
  SolverOptions options;
  options.type = GetParam();
  options.factors.motion.rotation_floor_rad = 0.01;
  options.factors.motion.rotation_per_rotation = 1e-3;
  options.factors.motion.rotation_per_translation_rad_m = 1e-3;
  std::vector<Pose2> motions = Motions(room.graph);
  for (Pose2& motion : motions) motion.yaw += 0.06;
  room.graph = room.graph.Corrected({motions, {}, {}, {}, {}});
  ASSERT_TRUE(StartFromConstraints(room.graph, room.state.poses, options.factors.motion));
  const SolverSummary summary = RefineState(options, room.graph, &room.state);
  EXPECT_FALSE(summary.started_from_constraints);
  EXPECT_THAT(summary.message, Not(HasSubstr("started from odometry")));
  EXPECT_LT(WorstError(room.state.poses, room.truth), 0.05);
}

}  // namespace
}  // namespace plumbline
