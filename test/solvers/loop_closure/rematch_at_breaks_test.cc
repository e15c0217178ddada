#include "plumbline/solvers/loop_closure/rematch_at_breaks.h"

#include <gtest/gtest.h>

#include "plumbline/test/solvers/seeding_testing.h"

namespace plumbline {
namespace {

constexpr int kPosesPerKey = 3;
constexpr int kBrokenEdge = 6;  // from pose 18 to pose 21
constexpr int kFirstAfter = 20;
// The first keyframe at least 2 m of path beyond pose 21.
constexpr int kSoundPose = 42;

// A lap of radius 1 m round the room, 10 cm a step, carried on ahead of pose 20. All keyframes have
// been put right; from there to where the path is sound again the other poses are not.
struct RepairedLap {
  SlamGraph graph;  // initial guesses at the true poses
  std::vector<SurfacePoints> surfaces;
  KeyframeGraph keys;
  std::vector<Pose2> odometry;
  std::vector<Pose2> world_from_robot;
};

void AddKeyframes(const std::vector<Pose2>& poses, KeyframeGraph* keys) {
  for (int pose = 0; pose <= 60; pose += kPosesPerKey) {
    Keyframe key;
    key.pose = key.scan = pose;
    key.path_m = 0.1 * pose;
    keys->keyframes.push_back(key);
    keys->world_from_key.push_back(poses[pose]);
  }
}

RepairedLap MakeRepairedLap() {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.01;
  RepairedLap lap;
  for (int i = 0; i <= 60; ++i) {
    const double angle = 0.1 * i;
    scene.poses.emplace_back(std::cos(angle), std::sin(angle), angle + 0.5 * kPi);
    lap.odometry.emplace_back();
    if (i == 0) continue;
    const Pose2 step = Between(scene.poses[i - 1], scene.poses[i]);
    lap.odometry[i] = Pose2(1.2 * step.x, step.y, 0.8 * step.yaw);
  }
  lap.odometry[kFirstAfter] = Pose2(0.0, 0.0, 0.0);
  lap.graph = MakeGraph(scene);
  lap.surfaces = SurfacesOf(lap.graph);
  lap.world_from_robot = scene.poses;
  for (int pose = 19; pose < kSoundPose; ++pose) {
    lap.world_from_robot[pose] = Pose2(0.3, -0.2, 0.1) * scene.poses[pose];
  }
  AddKeyframes(scene.poses, &lap.keys);
  for (int k = 1; k < lap.keys.size(); ++k) {
    const Pose2 step = Between(lap.keys.world_from_key[k - 1], lap.keys.world_from_key[k]);
    lap.keys.sequential.push_back({{k - 1, k, step}});
  }
  return lap;
}

// The sequential matching went to a place 0.7 m away there, which closures have shown since.
void Break(int edge, int first_after, RepairedLap* lap) {
  SequentialEdge& broken = lap->keys.sequential[edge];
  broken.constraint.from_from_to = broken.constraint.from_from_to * Pose2(0.6, -0.4, 0.2);
  broken.evidence = 1.0;
  broken.broken = true;
  broken.first_pose_after = first_after;
}

std::vector<Pose2> Rematched(const RepairedLap& lap) {
  std::vector<Pose2> poses = lap.world_from_robot;
  RematchAtBreaks(ScanSurfaces(lap.graph, Packed(lap.surfaces)), lap.keys, lap.odometry,
                  MotionOptions(), &poses);
  return poses;
}

bool SamePose(const Pose2& a, const Pose2& b) { return a.x == b.x && a.y == b.y && a.yaw == b.yaw; }

TEST(RematchAtBreaks, MendsThePosesNextToABreakAndNoOthers) {
  RepairedLap lap = MakeRepairedLap();
  Break(kBrokenEdge, kFirstAfter, &lap);
  const std::vector<Pose2> poses = Rematched(lap);
  for (int pose = 0; pose <= 60; ++pose) {
    EXPECT_LT(DistanceM(poses[pose], lap.graph.InitialPose(pose)), 0.01) << pose;
    EXPECT_NEAR(poses[pose].yaw, lap.graph.InitialPose(pose).yaw, 0.01) << pose;
    if (pose > 15 && pose < kSoundPose)
      continue;  // from the last keyframe that is known to be sound
    EXPECT_TRUE(SamePose(poses[pose], lap.world_from_robot[pose])) << pose;
  }
}

TEST(RematchAtBreaks, LeavesAPathWithoutBreaks) {
  RepairedLap lap = MakeRepairedLap();
  lap.keys.sequential[kBrokenEdge].evidence = 1.0;
  const std::vector<Pose2> poses = Rematched(lap);
  for (int pose = 0; pose <= 60; ++pose) {
    EXPECT_TRUE(SamePose(poses[pose], lap.world_from_robot[pose])) << pose;
  }
}

TEST(RematchAtBreaks, TheOdometryLeadsToAPoseWithoutAView) {
  RepairedLap lap = MakeRepairedLap();
  Break(kBrokenEdge, kFirstAfter, &lap);
  // On either side of the break.
  lap.surfaces[19].clear();
  lap.surfaces[20].clear();
  const std::vector<Pose2> poses = Rematched(lap);
  EXPECT_TRUE(SamePose(poses[19], poses[18] * lap.odometry[19]));
  EXPECT_TRUE(SamePose(poses[20], poses[21] * lap.odometry[21].Inverse()));
}

TEST(RematchAtBreaks, TheNextBreakEndsWhatWasSpoilt) {
  RepairedLap lap = MakeRepairedLap();
  Break(kBrokenEdge, kFirstAfter, &lap);
  // From pose 27 to pose 30: between the breaks only the keyframe at pose 27 is sound.
  Break(9, 29, &lap);
  lap.world_from_robot[27] = lap.graph.InitialPose(27);
  const std::vector<Pose2> poses = Rematched(lap);
  EXPECT_TRUE(SamePose(poses[27], lap.world_from_robot[27]));
  for (int pose = 0; pose <= 60; ++pose) {
    EXPECT_LT(DistanceM(poses[pose], lap.graph.InitialPose(pose)), 0.01) << pose;
  }
}

TEST(RematchAtBreaks, WhatOneBreakSpoiltIsNoMapForTheNext) {
  RepairedLap lap = MakeRepairedLap();
  Break(kBrokenEdge, kFirstAfter, &lap);
  Break(9, 29, &lap);
  lap.world_from_robot[27] = lap.graph.InitialPose(27);
  const std::vector<Pose2> expected = Rematched(lap);
  // The keyframes at poses 21 and 24, between the two breaks, are a metre off.
  for (const int k : {7, 8})
    lap.keys.world_from_key[k] = Pose2(0.9, 0.5, 0.2) * lap.keys.world_from_key[k];
  const std::vector<Pose2> poses = Rematched(lap);
  for (int pose = 0; pose <= 60; ++pose) {
    EXPECT_TRUE(SamePose(poses[pose], expected[pose])) << pose;
  }
}

TEST(RematchAtBreaks, TheKeyframeBeforeABreakMayLieBeyondIt) {
  RepairedLap lap = MakeRepairedLap();
  // The robot was carried ahead of pose 18, whose scan was matched to the place before.
  lap.odometry[kFirstAfter] = lap.odometry[kFirstAfter + 1];
  lap.odometry[18] = Pose2(0.0, 0.0, 0.0);
  Break(kBrokenEdge, kFirstAfter, &lap);
  const Pose2 astray = Pose2(0.3, -0.2, 0.1) * lap.graph.InitialPose(18);
  lap.keys.world_from_key[kBrokenEdge] = lap.world_from_robot[18] = astray;
  EXPECT_LT(DistanceM(Rematched(lap)[18], lap.graph.InitialPose(18)), 0.01);
}

// Of a corridor without end, where each scan fits everywhere.
RepairedLap MakeCorridor(double pause_s) {
  SyntheticScene scene;
  scene.laser = PanoramicLaser(360);
  scene.laser.max_range_m = 8.0;
  scene.faces = {{{-50.0, -1.0}, {50.0, -1.0}}, {{-50.0, 1.0}, {50.0, 1.0}}};
  RepairedLap lap;
  for (int i = 0; i <= 60; ++i) {
    // Carried by 2 m ahead of the first pose after the pause.
    scene.poses.emplace_back(0.1 * i + (i >= kFirstAfter ? 2.0 : 0.0), 0.0, 0.0);
    lap.odometry.emplace_back(i == 0 ? 0.0 : 0.1, 0.0, 0.0);
  }
  const SlamGraph at_once = MakeGraph(scene);
  const int laser = lap.graph.AddLaser(scene.laser);
  for (int i = 0; i <= 60; ++i) {
    const double time_s = i + (i >= kFirstAfter ? pause_s : 0.0);
    const int pose = lap.graph.AddPose(scene.poses[i], time_s);
    lap.graph.AddScan(pose, laser, at_once.RangesOfScan(i, 0.0));
  }
  lap.surfaces = SurfacesOf(lap.graph);
  lap.world_from_robot = scene.poses;
  AddKeyframes(scene.poses, &lap.keys);
  for (int k = 1; k < lap.keys.size(); ++k)
    lap.keys.sequential.push_back({{k - 1, k, {0.3, 0, 0}}});
  // Nobody knows where on the edge it is.
  lap.keys.sequential[kBrokenEdge].evidence = 1.0;
  lap.keys.sequential[kBrokenEdge].broken = true;
  lap.keys.sequential[kBrokenEdge].first_pose_after = 21;
  return lap;
}

TEST(RematchAtBreaks, ARobotIsCarriedWhileNothingIsRecorded) {
  const RepairedLap paused = MakeCorridor(5.0);
  const std::vector<Pose2> poses = Rematched(paused);
  for (int pose = 16; pose < kSoundPose; ++pose) {
    EXPECT_LT(DistanceM(poses[pose], paused.graph.InitialPose(pose)), 0.1) << pose;
  }
  // Without a pause the sequential matching is believed.
  const RepairedLap at_once = MakeCorridor(0.0);
  EXPECT_GT(DistanceM(Rematched(at_once)[kFirstAfter], at_once.graph.InitialPose(kFirstAfter)),
            1.0);
}

}  // namespace
}  // namespace plumbline
