#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/acceptance/candidate.h"

namespace plumbline {
namespace {

constexpr int kNumPoses = 40;

// Per pose 20 residuals, one per return; `rise` is what the error of each return grows by.
std::vector<PoseChange> Changes(double seed_error, const std::vector<double>& rises) {
  constexpr int kReturns = 20;
  std::vector<PoseChange> changes;
  for (const double rise : rises) {
    PoseChange change;
    change.num_residuals = kReturns;
    change.seed_error = kReturns * seed_error;
    change.state_error = kReturns * (seed_error + rise);
    change.squares = kReturns * rise * rise;
    changes.push_back(change);
  }
  return changes;
}

std::vector<double> PosesAlongALine(double bend) {
  std::vector<double> poses;
  for (int i = 0; i < kNumPoses; ++i) {
    poses.insert(poses.end(), {0.2 * i, bend * std::sin(0.3 * i), 0.01 * i});
  }
  return poses;
}

Pose2 PoseAt(const std::vector<double>& poses, int i) { return Pose2(&poses[3 * i]); }

void ExpectSameStep(const std::vector<double>& a, const std::vector<double>& b, int from, int to,
                    double tolerance) {
  const Pose2 difference =
      Between(Between(PoseAt(a, from), PoseAt(a, to)), Between(PoseAt(b, from), PoseAt(b, to)));
  EXPECT_NEAR(difference.x, 0.0, tolerance);
  EXPECT_NEAR(difference.y, 0.0, tolerance);
  EXPECT_NEAR(difference.yaw, 0.0, tolerance);
}

TEST(LocalAcceptanceTest, AStretchIsWorseThoughTheWholeIsBetter) {
  std::vector<double> rises(kNumPoses, -0.4);
  for (int i = 12; i < 15; ++i) rises[i] = 4.0;
  const std::vector<WorseStretch> worse = FindWorseStretches(Changes(0.6, rises));
  ASSERT_EQ(worse.size(), 1u);
  EXPECT_EQ(worse[0].first, 12);
  EXPECT_EQ(worse[0].last, 14);
  EXPECT_NEAR(worse[0].seed_error, 0.6, 1e-12);
  EXPECT_NEAR(worse[0].state_error, 4.6, 1e-12);
}

TEST(LocalAcceptanceTest, ASmallRiseAChanceAndFewResidualsAreNotWorse) {
  EXPECT_TRUE(FindWorseStretches(Changes(0.6, std::vector<double>(kNumPoses, 0.5))).empty());
  // A rise to less than twice what it was.
  EXPECT_TRUE(FindWorseStretches(Changes(3.0, std::vector<double>(kNumPoses, 2.0))).empty());
  std::vector<PoseChange> by_chance = Changes(0.6, {0.0, 2.0, 0.0});
  by_chance[1].squares *= 3.0;  // up and down, and up on the whole
  EXPECT_TRUE(FindWorseStretches(by_chance).empty());
  std::vector<PoseChange> few = Changes(0.6, {0.0, 0.0, 0.0});
  few[1] = {10, 6.0, 100.0, 800.0};
  EXPECT_TRUE(FindWorseStretches(few).empty());
  EXPECT_TRUE(FindWorseStretches({}).empty());
}

// As of a laser with so few beams that no pose can be judged alone.
TEST(LocalAcceptanceTest, ManyPosesWithFewResidualsAreWorseTogether) {
  std::vector<PoseChange> changes(kNumPoses, {2, 1.2, 1.2, 0.1});
  for (int i = 10; i < 30; ++i) changes[i] = {2, 1.2, 12.0, 60.0};
  const std::vector<WorseStretch> worse = FindWorseStretches(changes);
  ASSERT_EQ(worse.size(), 1u);
  EXPECT_NEAR(worse[0].first, 10, 7);
  EXPECT_NEAR(worse[0].last, 29, 7);
}

TEST(LocalAcceptanceTest, StretchesThatTouchBecomeOne) {
  const std::vector<WorseStretch> merged =
      MergeStretches({{20, 22, 1.0, 3.0}, {3, 5, 1.0, 9.0}}, {{6, 6, 1.0, 4.0}, {8, 9, 1.0, 4.0}});
  ASSERT_EQ(merged.size(), 3u);
  EXPECT_EQ(merged[0].first, 3);
  EXPECT_EQ(merged[0].last, 6);
  EXPECT_EQ(merged[0].state_error, 9.0);
  EXPECT_EQ(merged[1].first, 8);
  EXPECT_EQ(merged[2].last, 22);
}

TEST(LocalAcceptanceTest, WideningStaysWithinTheDrive) {
  std::vector<WorseStretch> stretches = {{1, 2}, {10, 12}, {38, 39}};
  WidenStretches(kNumPoses, &stretches);
  EXPECT_EQ(stretches[0].first, 0);
  EXPECT_EQ(stretches[0].last, 4);
  EXPECT_EQ(stretches[1].first, 7);
  EXPECT_EQ(stretches[1].last, 15);
  EXPECT_EQ(stretches[2].last, 39);
}

// The sound poses have been moved by a turn and a shift, those of the stretch torn away.
TEST(LocalAcceptanceTest, AStretchIsCarriedAlongWithItsNeighbours) {
  const std::vector<double> seed = PosesAlongALine(0.5);
  const Pose2 shift(0.3, -0.1, 0.2);
  std::vector<double> poses;
  for (int i = 0; i < kNumPoses; ++i) {
    const Pose2 moved = shift * PoseAt(seed, i);
    const double torn_m = i >= 20 && i < 26 ? 1.5 : 0.0;
    poses.insert(poses.end(), {moved.x + torn_m, moved.y, moved.yaw});
  }
  PutBack({{20, 25}}, {}, seed, &poses);
  for (int i = 1; i < kNumPoses; ++i) ExpectSameStep(seed, poses, i - 1, i, 1e-9);
}

TEST(LocalAcceptanceTest, WhatTheNeighboursDifferByIsSharedOut) {
  const std::vector<double> seed = PosesAlongALine(0.0);
  std::vector<double> poses = seed;
  for (int i = 0; i < kNumPoses; ++i) poses[3 * i + 1] += i < 10 ? 0.0 : i < 13 ? 2.0 : 0.08;
  PutBack({{10, 12}}, {}, seed, &poses);
  for (int i = 9; i < 13; ++i) {
    EXPECT_NEAR(poses[3 * i + 4] - poses[3 * i + 1], 0.02, 1e-12) << i;
    EXPECT_NEAR(poses[3 * i], seed[3 * i], 1e-12);
  }
}

TEST(LocalAcceptanceTest, AnEndGoesAlongWithItsOneNeighbourAndFixedPosesStay) {
  const std::vector<double> seed = PosesAlongALine(0.3);
  std::vector<double> poses;
  const Pose2 shift(0.0, 0.2, 0.1);
  for (int i = 0; i < kNumPoses; ++i) {
    const Pose2 moved = i < 3 ? Pose2(9.0, 9.0, 1.0) : shift * PoseAt(seed, i);
    poses.insert(poses.end(), {moved.x, moved.y, moved.yaw});
  }
  std::vector<double> fixed = poses;
  PutBack({{0, 2}}, {}, seed, &poses);
  for (int i = 1; i < 5; ++i) ExpectSameStep(seed, poses, i - 1, i, 1e-9);
  PutBack({{0, 2}}, {{1, PoseAt(fixed, 1)}}, seed, &fixed);
  EXPECT_EQ(fixed[3], 9.0);
  EXPECT_NE(fixed[0], 9.0);
  std::vector<double> all(seed.size(), 5.0);
  PutBack({{0, kNumPoses - 1}}, {}, seed, &all);
  for (std::size_t i = 0; i < seed.size(); ++i) EXPECT_NEAR(all[i], seed[i], 1e-12);
}

}  // namespace
}  // namespace plumbline
