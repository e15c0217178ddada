#include "plumbline/solvers/loop_closure/close_loops.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

const Eigen::Matrix3d kStepCovariance = Eigen::Vector3d(1e-4, 1e-4, 2.5e-5).asDiagonal();

// A lap and a fifth of radius 3 m round a hall of 12 m x 10 m that looks the same from nowhere
// else, by keyframes half a metre apart: 38 a lap, so that the last eight are back at the first.
// The sequential matching is exact.
struct Lap {
  SlamGraph graph;  // initial guesses at the true poses
  std::vector<SurfacePoints> surfaces;
  KeyframeGraph keys;

  Pose2 TrueStep(int from, int to) const {
    return Between(graph.InitialPose(from), graph.InitialPose(to));
  }
  // Of the last keyframe, as seen from the first one [m].
  double ErrorM() const {
    const int last = keys.size() - 1;
    return DistanceM(Between(keys.world_from_key[0], keys.world_from_key[last]), TrueStep(0, last));
  }
  // Puts the keyframes where the sequential edges say.
  void FollowEdges() {
    for (int k = 1; k < keys.size(); ++k) {
      keys.world_from_key[k] =
          keys.world_from_key[k - 1] * keys.sequential[k - 1].constraint.from_from_to;
    }
  }
  LoopClosingReport Close() {
    ThreadPool pool(2);
    ClosureMemory memory;
    LoopClosingReport report;
    EXPECT_TRUE(
        CloseLoops(ScanSurfaces(graph, Packed(surfaces)), nullptr, &pool, &memory, &keys, &report)
            .ok());
    return report;
  }
};

Lap MakeLap() {
  SyntheticScene scene;
  scene.faces = Rectangle({-6.0, -5.0}, {6.0, 5.0});
  scene.faces.push_back({{3.5, 5.0}, {3.5, 3.8}});
  scene.faces.push_back({{-6.0, 1.0}, {-4.5, 1.0}});
  scene.discs.push_back({{-4.6, -3.6}, 0.5});
  scene.laser = PanoramicLaser(360);
  scene.range_sigma_m = 0.01;
  Lap lap;
  for (int k = 0; k <= 45; ++k) {
    const double angle = k / 6.0;
    scene.poses.emplace_back(3.0 * std::cos(angle), 3.0 * std::sin(angle), angle + 0.5 * kPi);
    Keyframe key;
    key.pose = key.scan = k;
    key.path_m = 0.5 * k;
    lap.keys.keyframes.push_back(key);
  }
  lap.graph = MakeGraph(scene);
  lap.surfaces = SurfacesOf(lap.graph);
  lap.keys.world_from_key = scene.poses;
  for (int k = 1; k < lap.keys.size(); ++k) {
    lap.keys.sequential.push_back({{k - 1, k, lap.TrueStep(k - 1, k), kStepCovariance}});
  }
  return lap;
}

// From keyframe 20 on all is believed to be somewhere else.
constexpr int kWrongEdge = 20;
Lap MakeLapWithAWrongEdge() {
  Lap lap = MakeLap();
  SequentialEdge& edge = lap.keys.sequential[kWrongEdge];
  edge.constraint.from_from_to = edge.constraint.from_from_to * Pose2(1.2, 0.9, -0.2);
  edge.evidence = 0.7;
  edge.in_question = true;
  edge.first_pose_after = kWrongEdge + 1;
  lap.FollowEdges();
  return lap;
}

TEST(MakeKeyframeGraph, AddsWhatMatchAndOdometryKnow) {
  // Two steps ahead to a keyframe that is turned to the left. Its match knows the robot's forward
  // direction, the odometry the rest.
  SequentialTrajectory trajectory;
  trajectory.world_from_robot = {Pose2(5.0, 0.0, 0.0), Pose2(6.0, 0.0, 0.0),
                                 Pose2(7.0, 0.0, 0.5 * kPi)};
  trajectory.odometry = {Pose2(), Pose2(1.0, 0.0, 0.0), Pose2(1.0, 0.0, 0.5 * kPi)};
  trajectory.keyframes.resize(2);
  trajectory.keyframes[1].pose = trajectory.keyframes[1].scan = 2;
  trajectory.keyframes[1].information = Eigen::Vector3d(1e7, 0.0, 0.0).asDiagonal();
  const MotionOptions only_floors{0.0, 0.0, 0.0, 0.0, 0.1, 0.2};
  const KeyframeGraph keys = MakeKeyframeGraph(trajectory, only_floors);
  ASSERT_EQ(keys.size(), 2);
  EXPECT_EQ(keys.world_from_key[1].x, 7.0);
  ASSERT_EQ(keys.sequential.size(), 1u);
  const SequentialEdge& edge = keys.sequential[0];
  EXPECT_EQ(edge.evidence, 0.0);
  EXPECT_EQ(edge.constraint.from, 0);
  EXPECT_EQ(edge.constraint.to, 1);
  EXPECT_NEAR(edge.constraint.from_from_to.x, 2.0, 1e-12);
  EXPECT_NEAR(edge.constraint.from_from_to.yaw, 0.5 * kPi, 1e-12);
  // Along: twice 0.1 m. Across: ten points count as one, above the floor of 3 mm. The turn: twice
  // 0.2 rad, less what the match, which knows y, says of the first one.
  const Eigen::Matrix3d& covariance = edge.constraint.covariance;
  EXPECT_NEAR(covariance(0, 0), 0.02, 1e-4);
  EXPECT_NEAR(covariance(1, 1), 1e-6 + 0.003 * 0.003, 1e-8);
  EXPECT_NEAR(covariance(2, 2), 0.08 - 0.04 * 0.04 / 0.06, 1e-3);
}

TEST(CloseLoops, PullsADriftingLoopShut) {
  Lap lap = MakeLap();
  // Four steps at the far end, where little was seen, are 0.1 m too long each.
  for (int edge = 17; edge < 21; ++edge) {
    lap.keys.sequential[edge].constraint.from_from_to.x += 0.1;
    lap.keys.sequential[edge].constraint.covariance(0, 0) = 0.01;
  }
  lap.FollowEdges();
  EXPECT_GT(lap.ErrorM(), 0.35);
  const LoopClosingReport report = lap.Close();
  EXPECT_GE(report.num_closures, 4);
  EXPECT_GE(report.num_candidates, report.num_closures);
  EXPECT_EQ(report.num_contradicted, 0);
  EXPECT_TRUE(report.suspect_steps.empty());
  EXPECT_LT(lap.ErrorM(), 0.02);
  for (int edge = 17; edge < 21; ++edge) {
    const Pose2 step = Between(lap.keys.world_from_key[edge], lap.keys.world_from_key[edge + 1]);
    EXPECT_LT(DistanceM(step, lap.TrueStep(edge, edge + 1)), 0.03) << edge;
  }
}

TEST(CloseLoops, DropsAClosureThatTheOthersContradict) {
  Lap lap = MakeLap();
  Pose2 wrong = lap.TrueStep(5, 25);
  wrong.y += 3.0;
  lap.keys.closures.push_back({5, 25, wrong, kStepCovariance});
  const LoopClosingReport report = lap.Close();
  EXPECT_EQ(report.num_contradicted, 1);
  ASSERT_EQ(lap.keys.contradicted.size(), 1u);
  EXPECT_EQ(lap.keys.contradicted[0].to, 25);
  EXPECT_GE(report.num_closures, 4);
  int num_records = 0;
  for (const LoopClosureRecord& match : report.matches) {
    if (match.outcome != ClosureOutcome::kContradicted) continue;
    ++num_records;
    EXPECT_EQ(match.from_pose, 5);
    EXPECT_EQ(match.to_pose, 25);
    EXPECT_EQ(match.from_from_to.y, wrong.y);
  }
  EXPECT_EQ(num_records, 1);
  EXPECT_LT(lap.ErrorM(), 0.02);
}

TEST(CloseLoops, ASuspectEdgeGivesWayToClosuresAcross) {
  Lap lap = MakeLapWithAWrongEdge();
  EXPECT_GT(lap.ErrorM(), 1.0);
  const LoopClosingReport report = lap.Close();
  ASSERT_EQ(report.suspect_steps.size(), 1u);
  const SuspectStep& suspect = report.suspect_steps[0];
  EXPECT_EQ(suspect.first_pose_after, kWrongEdge + 1);
  EXPECT_EQ(suspect.evidence, 0.7);
  EXPECT_TRUE(suspect.broken);
  EXPECT_NEAR(suspect.turned_rad, 0.2, 0.01);
  EXPECT_GE(suspect.num_closures_across, 2);
  EXPECT_FALSE(suspect.IsUnresolved());
  EXPECT_TRUE(lap.keys.sequential[kWrongEdge].broken);
  EXPECT_LT(lap.ErrorM(), 0.02);
}

// What lies before and after the edge may be tied by way of another session.
TEST(CloseLoops, ASuspectEdgeGivesWayToClosuresWithAnotherSession) {
  Lap lap = MakeLapWithAWrongEdge();
  // The last ten keyframes are a session of their own, with closures to both sides of the edge.
  constexpr int kBoundary = 35;
  SequentialEdge& boundary = lap.keys.sequential[kBoundary];
  boundary.broken = boundary.between_sessions = true;
  for (const int key : {kBoundary + 2, kBoundary + 4}) {
    lap.keys.closures.push_back({key - 35, key, lap.TrueStep(key - 35, key), kStepCovariance});
    lap.keys.closures.push_back({key - 8, key, lap.TrueStep(key - 8, key), kStepCovariance});
  }
  const LoopClosingReport report = lap.Close();
  EXPECT_TRUE(lap.keys.sequential[kWrongEdge].broken);
  ASSERT_EQ(report.suspect_steps.size(), 1u);
  EXPECT_GE(report.suspect_steps[0].num_closures_across, 2);
  EXPECT_LT(DistanceM(Between(lap.keys.world_from_key[0], lap.keys.world_from_key[30]),
                      lap.TrueStep(0, 30)),
            0.05);
}

TEST(CloseLoops, ASuspectEdgeThatIsRightStays) {
  Lap lap = MakeLap();
  lap.keys.sequential[kWrongEdge].evidence = 0.2;
  lap.keys.sequential[kWrongEdge].in_question = true;
  lap.keys.sequential[kWrongEdge].first_pose_after = kWrongEdge + 1;
  const LoopClosingReport report = lap.Close();
  ASSERT_EQ(report.suspect_steps.size(), 1u);
  EXPECT_FALSE(report.suspect_steps[0].broken);
  EXPECT_EQ(report.suspect_steps[0].turned_rad, 0.0);
  EXPECT_FALSE(report.suspect_steps[0].IsUnresolved());
}

TEST(CloseLoops, AnUnmatchedScanIsASignWhereItIsRare) {
  Lap lap = MakeLap();
  SequentialEdge& edge = lap.keys.sequential[kWrongEdge];
  edge.evidence = 0.2;
  lap.keys.keyframes[kWrongEdge + 1].after_unmatched = true;
  Lap with_another = lap;
  with_another.keys.keyframes[3].after_unmatched = true;
  LoopClosingReport report = lap.Close();
  ASSERT_EQ(report.suspect_steps.size(), 1u);
  EXPECT_TRUE(report.suspect_steps[0].unmatched);
  // Two of 46.
  report = with_another.Close();
  ASSERT_EQ(report.suspect_steps.size(), 1u);
  EXPECT_FALSE(report.suspect_steps[0].unmatched);
}

TEST(CloseLoops, StopsWhenItsCallerSaysSo) {
  Lap lap = MakeLap();
  ThreadPool pool(1);
  ClosureMemory memory;
  LoopClosingReport report;
  const Status status = CloseLoops(
      ScanSurfaces(lap.graph, Packed(lap.surfaces)),
      [](SeedingPhase phase, int, int) { return phase != SeedingPhase::kClosingLoops; }, &pool,
      &memory, &lap.keys, &report);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
}

TEST(CloseLoops, AStepThatIsNotInQuestionStays) {
  Lap lap = MakeLapWithAWrongEdge();
  lap.keys.sequential[kWrongEdge].in_question = false;
  const LoopClosingReport report = lap.Close();
  ASSERT_EQ(report.suspect_steps.size(), 1u);
  EXPECT_FALSE(report.suspect_steps[0].broken);
}

TEST(CloseLoops, TestsNothingTwice) {
  Lap lap = MakeLap();
  ThreadPool pool(1);
  ClosureMemory memory;
  LoopClosingReport report;
  KeyframeGraph once = lap.keys, again = lap.keys;
  int num_tested = 0;
  const SeedingProgress count = [&](SeedingPhase, int, int num_total) {
    num_tested += num_total;
    return true;
  };
  ASSERT_TRUE(CloseLoops(ScanSurfaces(lap.graph, Packed(lap.surfaces)), count, &pool, &memory,
                         &once, &report)
                  .ok());
  EXPECT_GT(num_tested, 0);
  num_tested = 0;
  ASSERT_TRUE(CloseLoops(ScanSurfaces(lap.graph, Packed(lap.surfaces)), count, &pool, &memory,
                         &again, &report)
                  .ok());
  EXPECT_EQ(num_tested, 0);
  ASSERT_EQ(once.closures.size(), again.closures.size());
  for (int k = 0; k < once.size(); ++k) {
    EXPECT_EQ(once.world_from_key[k].x, again.world_from_key[k].x) << k;
  }
}

TEST(CloseLoops, DoesNotFindAgainWhatWasRefused) {
  Lap lap = MakeLap();
  const LoopClosingReport with_all = lap.Close();
  ASSERT_GE(with_all.num_closures, 4);
  Lap without = MakeLap();
  without.keys.refused = lap.keys.closures;
  const LoopClosingReport report = without.Close();
  EXPECT_EQ(report.num_closures, 0);
  EXPECT_EQ(report.num_contradicted, with_all.num_closures);
}

TEST(SuspectStep, IsResolvedByTwoClosuresAcrossUnlessItTurnedTheMap) {
  SuspectStep suspect;
  suspect.evidence = 0.4;
  EXPECT_FALSE(suspect.IsUnresolved());  // not much of a suspect
  suspect.unmatched = true;
  EXPECT_TRUE(suspect.IsUnresolved());
  suspect.unmatched = false;
  suspect.evidence = SuspectStep::kUntrustedEvidence;
  EXPECT_TRUE(suspect.IsUnresolved());
  suspect.num_closures_across = 1;
  EXPECT_TRUE(suspect.IsUnresolved());
  suspect.num_closures_across = 2;
  EXPECT_FALSE(suspect.IsUnresolved());
  suspect.turned_rad = -0.6;
  EXPECT_TRUE(suspect.IsUnresolved());
  suspect.turned_rad = 0.4;
  EXPECT_FALSE(suspect.IsUnresolved());
  suspect.num_alternatives = 1;
  EXPECT_TRUE(suspect.IsUnresolved());
  suspect.num_alternatives = 0;
  suspect.evidence = 0.2;
  suspect.broken = true;
  EXPECT_FALSE(suspect.IsUnresolved());
  suspect.num_closures_across = 1;
  EXPECT_TRUE(suspect.IsUnresolved());
}

// Six poses one metre apart along x, keyframes at the second and the fifth; the latter has moved.
KeyframeGraph TwoKeysOfSix(const Pose2& moved) {
  KeyframeGraph keys;
  keys.keyframes.resize(2);
  keys.keyframes[0].pose = 1;
  keys.keyframes[1].pose = 4;
  keys.world_from_key = {Pose2(1.0, 0.0, 0.0), moved};
  keys.sequential.resize(1);
  return keys;
}

std::vector<Pose2> SixPoses() {
  std::vector<Pose2> poses;
  for (int i = 0; i < 6; ++i) poses.emplace_back(1.0 * i, 0.0, 0.0);
  return poses;
}

TEST(PosesFollowingKeyframes, SharesOutTheMoveInBetween) {
  const std::vector<Pose2> poses =
      PosesFollowingKeyframes(TwoKeysOfSix(Pose2(4.0, 0.6, 0.0)), SixPoses());
  const double expected_y[] = {0.0, 0.0, 0.2, 0.4, 0.6, 0.6};
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(poses[i].x, i, 1e-12);
    EXPECT_NEAR(poses[i].y, expected_y[i], 1e-12) << i;
  }
}

TEST(PosesFollowingKeyframes, TurnsWithTheKeyframe) {
  const std::vector<Pose2> poses =
      PosesFollowingKeyframes(TwoKeysOfSix(Pose2(4.0, 0.0, 0.3)), SixPoses());
  // One third of the way from where the first keyframe has it to where the second one has it.
  EXPECT_NEAR(poses[2].yaw, 0.1, 1e-12);
  EXPECT_NEAR(poses[2].x, 2.0 + (4.0 - 2.0 * std::cos(0.3) - 2.0) / 3.0, 1e-12);
  EXPECT_NEAR(poses[2].y, -2.0 * std::sin(0.3) / 3.0, 1e-12);
  // Beyond the last one all turns about it.
  EXPECT_NEAR(poses[5].yaw, 0.3, 1e-12);
  EXPECT_NEAR(poses[5].y, std::sin(0.3), 1e-12);
}

TEST(PosesFollowingKeyframes, ABrokenEdgeIsNotShared) {
  KeyframeGraph keys = TwoKeysOfSix(Pose2(4.0, 0.6, 0.0));
  keys.sequential[0].broken = true;
  keys.sequential[0].first_pose_after = 3;
  const std::vector<Pose2> poses = PosesFollowingKeyframes(keys, SixPoses());
  const double expected_y[] = {0.0, 0.0, 0.0, 0.6, 0.6, 0.6};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(poses[i].y, expected_y[i], 1e-12) << i;
}

TEST(PosesFollowingKeyframes, WithoutKeyframesNothingMoves) {
  const std::vector<Pose2> poses = PosesFollowingKeyframes(KeyframeGraph(), SixPoses());
  ASSERT_EQ(poses.size(), 6u);
  EXPECT_EQ(poses[3].x, 3.0);
}

}  // namespace
}  // namespace plumbline
