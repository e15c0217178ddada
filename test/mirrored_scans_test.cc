#include "plumbline/solvers/mirrored_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/solve.h"
#include "plumbline/test/synthetic_scene.h"

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

// As a host has it that counts the beams from the wrong side: every scan of which `is_reversed`.
template <typename Predicate>
SlamGraph Reversed(const SlamGraph& from, const Predicate& is_reversed) {
  SlamGraph graph;
  int laser = 0, pose = 0;
  EXPECT_TRUE(graph.AddLaser(from.laser(0), &laser).ok());
  for (int s = 0; s < from.num_scans(); ++s) {
    const ScanEntry& scan = from.scan(s);
    const int num_beams = from.laser(0).num_beams;
    std::vector<double> ranges(num_beams, std::numeric_limits<double>::infinity());
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const int beam = from.returns().beam[r];
      ranges[is_reversed(s) ? num_beams - 1 - beam : beam] = from.returns().range_m[r];
    }
    EXPECT_TRUE(graph.AddPose(from.WorldFromRobot(scan.pose), s, &pose).ok());
    EXPECT_TRUE(graph.AddScan(pose, laser, ranges).ok());
  }
  return graph;
}

bool Every(int /*scan*/) { return true; }

TEST(MirroredScansTest, TurnsTellScansFromTheirMirrorImages) {
  for (const int num_poses : {24, 60, 1000}) {  // turns of 30, 12 and 0.7 degrees
    const SlamGraph graph = MakeGraph(Room(num_poses));
    const TurnVotes sound = VoteOnTurns(graph);
    EXPECT_GE(sound.as_they_are, 20) << num_poses;
    EXPECT_EQ(sound.mirrored, 0) << num_poses;
    const TurnVotes mirrored = VoteOnTurns(Reversed(graph, Every));
    EXPECT_EQ(mirrored.as_they_are, sound.mirrored) << num_poses;
    EXPECT_EQ(mirrored.mirrored, sound.as_they_are) << num_poses;
  }
}

TEST(MirroredScansTest, SolveRefusesThemAndLeavesTheGraphAlone) {
  for (const SolverType type :
       {SolverType::kReduced, SolverType::kAlternatingCg, SolverType::kCeres}) {
    SlamGraph graph = Reversed(MakeGraph(Room(24)), Every);
    const SlamGraph given = graph;
    SolverOptions options;
    options.type = type;
    const SolverSummary summary = Solve(options, &graph);
    EXPECT_EQ(summary.termination, TerminationType::kFailure);
    EXPECT_THAT(summary.message, HasSubstr("the scans look mirrored: for 2"));
    EXPECT_EQ(graph.poses(), given.poses());
    EXPECT_EQ(graph.points(), given.points());
    CalibrationOptions mounting;
    mounting.laser_mounting = true;
    Calibration calibration;
    EXPECT_THAT(SolveWithCalibration(options, mounting, &graph, &calibration).message,
                HasSubstr("the scans look mirrored: for 2"));
    EXPECT_EQ(graph.poses(), given.poses());
  }
}

TEST(MirroredScansTest, YawCountedClockwiseIsTheSameMistake) {
  SyntheticScene scene = Room(24);
  scene.laser = PanoramicLaser(180);
  SlamGraph graph = MakeGraph(scene);
  EXPECT_TRUE(CheckScansAreNotMirrored(graph).ok());
  for (std::size_t i = 0; i < graph.poses().size(); i += 3) {
    graph.poses()[i + 1] *= -1.0;
    graph.poses()[i + 2] *= -1.0;
  }
  EXPECT_THAT(CheckScansAreNotMirrored(graph).message(), HasSubstr("counted clockwise"));
}

// The robust losses deal with some, and it takes enough turns to tell.
TEST(MirroredScansTest, NeedsAlmostAllOfEnoughTurns) {
  const SlamGraph graph = MakeGraph(Room(24));
  EXPECT_TRUE(
      CheckScansAreNotMirrored(Reversed(graph, [](int scan) { return scan % 5 == 0; })).ok());
  EXPECT_TRUE(CheckScansAreNotMirrored(Reversed(MakeGraph(Room(5)), Every)).ok());
  EXPECT_TRUE(CheckScansAreNotMirrored(SlamGraph()).ok());
}

TEST(MirroredScansTest, WhatLooksTheSameBothWaysDoesNotVote) {
  SyntheticScene scene;
  for (int side = 0; side < 72; ++side) {  // a round room
    const double from = DegToRad(5.0 * side), to = DegToRad(5.0 * (side + 1));
    scene.faces.push_back(
        {{4.0 * std::cos(from), 4.0 * std::sin(from)}, {4.0 * std::cos(to), 4.0 * std::sin(to)}});
  }
  for (int i = 0; i < 24; ++i) scene.poses.emplace_back(0.0, 0.0, DegToRad(20.0 * i));
  const TurnVotes votes = VoteOnTurns(MakeGraph(scene));
  EXPECT_EQ(votes.as_they_are + votes.mirrored, 0);
}

}  // namespace
}  // namespace plumbline
