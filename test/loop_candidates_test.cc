#include "plumbline/solvers/seeding/loop_candidates.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

struct Track {
  std::vector<KeyScan> key_scans;
  std::vector<Pose2> poses;

  void Add(const Pose2& pose, double path_m) {
    KeyScan key;
    key.pose = key.scan = static_cast<int>(key_scans.size());
    key.path_m = path_m;
    key_scans.push_back(key);
    poses.push_back(pose);
  }
};

// Straight on for 50 m, and a jump back to the start: 50 m of path that end 1.5 m from it.
Track Loop() {
  Track track;
  for (int i = 0; i < 50; ++i) track.Add({0.0, 1.0 * i, 0.0}, i);
  track.Add({1.5, 0.0, 0.0}, 50.0);
  return track;
}

TEST(LoopCandidates, DriftGrowsWithTheWayBetweenTheTwo) {
  const Track track = Loop();
  const auto candidates =
      FindLoopCandidates(LoopCandidateOptions(), track.key_scans, track.poses, {});
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_EQ(candidates[0].first, 0);
  EXPECT_EQ(candidates[0].second, 50);
  EXPECT_NEAR(candidates[0].drift_m, 0.4 + 0.025 * 50.0, 1e-9);
  EXPECT_NEAR(candidates[0].drift_rad, 0.15 + 0.002 * 50.0, 1e-9);
}

TEST(LoopCandidates, AClosureShortensTheWay) {
  const Track track = Loop();
  // From 10 m to 48 m in 0.3 m: the way from 0 to 50 is 10 + 0.3 + 2.
  const RelativePoseConstraint closure{10, 48, Pose2(0.3, 0.0, 0.0), Eigen::Matrix3d::Identity()};
  const auto candidates =
      FindLoopCandidates(LoopCandidateOptions(), track.key_scans, track.poses, {closure});
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_NEAR(candidates[0].drift_m, 0.4 + 0.025 * 12.3, 1e-9);
}

TEST(LoopCandidates, WhatIsClosedIsNotACandidateAgain) {
  const Track track = Loop();
  const RelativePoseConstraint closure{0, 50, Pose2(1.5, 0.0, 0.0), Eigen::Matrix3d::Identity()};
  EXPECT_TRUE(
      FindLoopCandidates(LoopCandidateOptions(), track.key_scans, track.poses, {closure}).empty());
}

TEST(LoopCandidates, OnePerVisitThatIsNearAndLongAgo) {
  Track track;
  // Past the origin at 0 m, 40 m and 80 m of path, far away in between.
  for (int i = 0; i <= 80; ++i) {
    const double phase = kPi * i / 40.0;
    track.Add({10.0 * std::sin(phase), 0.0, 0.0}, i);
  }
  const auto candidates =
      FindLoopCandidates(LoopCandidateOptions(), track.key_scans, track.poses, {});
  int of_last = 0;
  for (const LoopCandidate& candidate : candidates) {
    EXPECT_GE(candidate.second - candidate.first, 6);
    of_last += candidate.second == 80;
  }
  EXPECT_EQ(of_last, 2);
}

}  // namespace
}  // namespace plumbline
