#include "plumbline/solvers/acceptance/mirrored_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A scanner that looks more to the left than to the right, and does not see everything.
LaserModel LopsidedLaser() {
  LaserModel laser;
  laser.num_beams = 181;
  laser.first_bearing_rad = DegToRad(-60.0);
  laser.bearing_step_rad = DegToRad(1.0);
  laser.max_range_m = 4.0;
  laser.robot_from_laser = {0.2, 0.05, 0.4};
  return laser;
}

// Two rounds on an ellipse in a room with a partition.
SyntheticScene Room(int num_poses) {
  SyntheticScene scene;
  scene.faces = {{{-3, -2}, {3, -2}}, {{3, -2}, {3, 2}},  {{3, 2}, {-3, 2}},
                 {{-3, 2}, {-3, -2}}, {{0, 0.9}, {0, 2}}, {{-1.5, -1.2}, {-0.7, -1.2}}};
  scene.laser = LopsidedLaser();
  scene.range_sigma_m = 0.01;
  for (int i = 0; i < num_poses; ++i) {
    const double turn = 4.0 * kPi * i / num_poses;
    scene.poses.emplace_back(1.8 * std::cos(turn), 0.5 * std::sin(turn), turn + 0.5 * kPi);
  }
  return scene;
}

// As a host has it that counts the beams from the wrong side: every scan that `is_reversed` says.
template <typename Predicate>
SlamGraph Reversed(const SlamGraph& from, const Predicate& is_reversed) {
  SlamGraph graph;
  for (int s = 0; s < from.num_scans(); ++s) {
    const ScanEntry& scan = from.scan(s);
    std::vector<double> ranges = from.RangesOfScan(s, std::numeric_limits<double>::infinity());
    if (is_reversed(s)) std::reverse(ranges.begin(), ranges.end());
    const int laser = graph.AddLaser(from.LaserOfScan(s));
    const int pose = graph.AddPose(from.InitialPose(scan.pose), s);
    graph.AddScan(pose, laser, ranges);
  }
  return graph;
}

bool Every(int /*scan*/) { return true; }

// By the initial guesses.
TurnVotes Vote(const SlamGraph& graph) { return VoteOnTurns(graph, graph.initial_poses()); }
Status Check(const SlamGraph& graph) {
  return CheckScansAreNotMirrored(graph, graph.initial_poses(), std::nullopt);
}

void ExpectToldApart(const SyntheticScene& scene) {
  const SlamGraph graph = MakeGraph(scene);
  const TurnVotes sound = Vote(graph), mirrored = Vote(Reversed(graph, Every));
  EXPECT_TRUE(sound.SayRight());
  EXPECT_EQ(sound.mirrored, 0);
  EXPECT_GE(mirrored.mirrored, 20);
  EXPECT_EQ(mirrored.as_they_are, 0);
}

TEST(MirroredScansTest, TurnsTellScansFromTheirMirrorImages) {
  for (const int num_poses : {24, 60, 1000}) {  // turns of 30, 12 and 0.7 degrees
    SCOPED_TRACE(num_poses);
    ExpectToldApart(Room(num_poses));
  }
  // Beams counted clockwise, and rightly said to be.
  SyntheticScene scene = Room(24);
  scene.laser.first_bearing_rad = DegToRad(120.0);
  scene.laser.bearing_step_rad = DegToRad(-1.0);
  ExpectToldApart(scene);
}

TEST(MirroredScansTest, SoDoTwoLasersThatTakeTurns) {
  SyntheticScene scene = Room(48);
  const SlamGraph front = MakeGraph(scene);
  scene.laser.robot_from_laser = {-0.2, 0.0, kPi};
  const SlamGraph rear = MakeGraph(scene);
  SlamGraph both;
  for (int s = 0; s < front.num_scans(); ++s) {
    const int pose = both.AddPose(front.InitialPose(s), s);
    both.AddScanOf(s % 2 == 0 ? front : rear, s, pose);
  }
  EXPECT_TRUE(Vote(both).SayRight());
  EXPECT_GE(Vote(Reversed(both, Every)).mirrored, 20);
}

TEST(MirroredScansTest, UpsideDownIsNoticedWhereverTheFanLooks) {
  const SyntheticScene scene = Room(24);
  SyntheticScene hanging = scene;
  hanging.laser.first_bearing_rad *= -1.0;
  hanging.laser.bearing_step_rad *= -1.0;
  const SlamGraph seen = MakeGraph(hanging);
  SlamGraph told;
  const int laser = told.AddLaser(scene.laser);
  for (int s = 0; s < seen.num_scans(); ++s) {
    const std::vector<double> ranges =
        seen.RangesOfScan(s, std::numeric_limits<double>::infinity());
    const int pose = told.AddPose(seen.InitialPose(s), s);
    told.AddScan(pose, laser, ranges);
  }
  EXPECT_EQ(Vote(seen).mirrored, 0);
  EXPECT_TRUE(Vote(told).SayMirrored());
}

TEST(MirroredScansTest, SolveRefusesThemAndLeavesTheStateAlone) {
  for (const SolverType type :
       {SolverType::kReduced, SolverType::kAlternatingCg, SolverType::kCeres}) {
    const SlamGraph graph = Reversed(MakeGraph(Room(24)), Every);
    MapState state = graph.InitialState();
    SolverOptions options;
    options.type = type;
    const SolverSummary summary = RefineState(options, graph, &state);
    EXPECT_EQ(summary.termination, TerminationType::kFailure);
    EXPECT_THAT(summary.message, HasSubstr("the scans look mirrored: around 2"));
    EXPECT_EQ(state, graph.InitialState());
    CalibrationOptions mounting;
    mounting.laser_mounting = true;
    Calibration calibration;
    EXPECT_THAT(SolveWithCalibration(options, mounting, graph, &state, &calibration).message,
                HasSubstr("the scans look mirrored: around 2"));
    EXPECT_EQ(state, graph.InitialState());
  }
}

// With an odometry as good as the poses of the room, and solved by someone who knows how good.
SlamGraph WithOdometry(const std::vector<Pose2>& truth, SlamGraph graph) {
  for (int i = 0; i + 1 < graph.num_poses(); ++i) {
    graph.AddOdometry({i, i + 1, Between(truth[i], truth[i + 1])});
  }
  return graph;
}
SolverOptions GoodOdometry() {
  SolverOptions options;
  MotionOptions& motion = options.factors.motion;
  motion.rotation_per_rotation = motion.rotation_per_translation_rad_m = 0.05;
  motion.translation_per_translation = motion.translation_per_rotation_m_rad = 0.05;
  return options;
}

TEST(MirroredScansTest, ProcessesVoteTogether) {
  const SlamGraph seen = MakeGraph(Room(24));  // too few for one of them to say anything
  for (const bool mirrored : {false, true}) {
    RunOnParts(mirrored ? Reversed(seen, Every) : seen, 3, [&](const SlamGraph& part) {
      const TurnVotes votes = Vote(part);
      EXPECT_EQ(votes.SayRight(), !mirrored);
      EXPECT_EQ(votes.SayMirrored(), mirrored);
      EXPECT_GE(votes.as_they_are + votes.mirrored, 12);
      MapState state{part.initial_poses(), {}};
      EXPECT_EQ(RefineState(SolverOptions(), part, &state).IsSolutionUsable(), !mirrored);
    });
  }
}

TEST(MirroredScansTest, PosesThatTheOdometryReplacesAreNoReason) {
  SyntheticScene scene = Room(24);
  scene.laser = PanoramicLaser(180);
  const SlamGraph graph = WithOdometry(scene.poses, MakeGraph(scene));
  MapState state = graph.InitialState();
  for (int i = 0; i < graph.num_poses(); ++i) {  // a mirror image about the first pose's x axis
    const Pose2& pose = scene.poses[i];
    state.SetPose(i, {2.0 * scene.poses[0].x - pose.x, pose.y, kPi - pose.yaw});
  }
  EXPECT_TRUE(VoteOnTurns(graph, state.poses).SayMirrored());
  const SolverSummary summary = RefineState(GoodOdometry(), graph, &state);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.message;
  EXPECT_TRUE(summary.started_from_constraints);
}

TEST(MirroredScansTest, WherePosesSayNothingTheOdometryDoes) {
  const SyntheticScene scene = Room(24);
  const SlamGraph graph = WithOdometry(scene.poses, Reversed(MakeGraph(scene), Every));
  MapState state = graph.InitialState();
  std::fill(state.poses.begin(), state.poses.end(), 0.0);
  EXPECT_FALSE(VoteOnTurns(graph, state.poses).AreEnough());
  EXPECT_THAT(RefineState(GoodOdometry(), graph, &state).message,
              HasSubstr("the scans look mirrored"));
}

TEST(MirroredScansTest, ItTakesEnoughTurns) {
  SyntheticScene scene = Room(24);
  scene.poses.resize(7);
  const SlamGraph few = Reversed(MakeGraph(scene), Every);
  EXPECT_GE(Vote(few).mirrored, 5);
  EXPECT_LT(Vote(few).mirrored, 8);
  EXPECT_TRUE(Check(few).ok());
  EXPECT_TRUE(Check(SlamGraph()).ok());
}

// The robust losses deal with some mirrored scans.
TEST(MirroredScansTest, ItTakesAlmostAllVotes) {
  const SlamGraph graph = MakeGraph(Room(24));
  const SlamGraph most = Reversed(graph, [](int scan) { return scan >= 5; });
  EXPECT_GT(Vote(most).mirrored, 0);
  EXPECT_TRUE(Vote(most).SayRight());
  EXPECT_TRUE(Check(most).ok());
  const SlamGraph almost_all = Reversed(graph, [](int scan) { return scan >= 2; });
  EXPECT_EQ(Vote(almost_all).as_they_are, 1);
  EXPECT_FALSE(Check(almost_all).ok());
}

// A square room is the same after a quarter of a turn: 44 degrees, taken for 46, would fit as a
// mirror image.
TEST(MirroredScansTest, TurnsThatASquareForgivesDoNotVote) {
  SyntheticScene scene;
  scene.faces = {{{-2, -2}, {2, -2}}, {{2, -2}, {2, 2}}, {{2, 2}, {-2, 2}}, {{-2, 2}, {-2, -2}}};
  for (int i = 0; i < 24; ++i) scene.poses.emplace_back(0.0, 0.0, DegToRad(44.0 * i));
  const SlamGraph graph = MakeGraph(scene);
  std::vector<double> poses = graph.initial_poses();
  for (std::size_t i = 2; i < poses.size(); i += 3) poses[i] *= 46.0 / 44.0;
  EXPECT_FALSE(VoteOnTurns(graph, poses).SayMirrored());
}

TEST(MirroredScansTest, WhatLooksTheSameBothWaysDoesNotVote) {
  SyntheticScene scene;
  for (int side = 0; side < 72; ++side) {  // a round room
    const double from = DegToRad(5.0 * side), to = DegToRad(5.0 * (side + 1));
    scene.faces.push_back(
        {{4.0 * std::cos(from), 4.0 * std::sin(from)}, {4.0 * std::cos(to), 4.0 * std::sin(to)}});
  }
  for (int i = 0; i < 24; ++i) scene.poses.emplace_back(0.0, 0.0, DegToRad(20.0 * i));
  const TurnVotes votes = Vote(MakeGraph(scene));
  EXPECT_EQ(votes.as_they_are + votes.mirrored, 0);
}

}  // namespace
}  // namespace plumbline
