#include "plumbline/solvers/loop_closure/loop_candidates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

void Add(const Pose2& pose, double path_m, KeyframeGraph* keys) {
  Keyframe key;
  key.pose = key.scan = keys->size();
  key.path_m = path_m;
  keys->keyframes.push_back(key);
  keys->world_from_key.push_back(pose);
  if (keys->size() > 1) keys->sequential.emplace_back();
}

// Straight on for `length` metres, and a jump back to the start: a path that ends 1.5 m from it.
KeyframeGraph Loop(int length) {
  KeyframeGraph keys;
  for (int i = 0; i < length; ++i) Add({0.0, 1.0 * i, 0.0}, i, &keys);
  Add({1.5, 0.0, 0.0}, length, &keys);
  return keys;
}

std::vector<LoopCandidate> Find(const KeyframeGraph& keys) {
  ThreadPool pool(2);
  return FindLoopCandidates(keys, nullptr, &pool);
}

double DriftM(double way_m) { return 0.4 + 0.025 * way_m + 1e-4 * way_m * way_m; }

TEST(LoopCandidates, DriftGrowsWithTheWayBetweenTheTwo) {
  const std::vector<LoopCandidate> near = Find(Loop(20)), far = Find(Loop(54));
  ASSERT_EQ(near.size(), 1u);
  EXPECT_EQ(near[0].first, 0);
  EXPECT_EQ(near[0].second, 20);
  EXPECT_FALSE(near[0].wide());
  EXPECT_NEAR(near[0].drift_m, DriftM(20.0), 1e-9);
  EXPECT_NEAR(near[0].drift_rad, 0.15 + 0.001 * 20.0, 1e-9);
  ASSERT_EQ(far.size(), 1u);
  EXPECT_NEAR(far[0].drift_m, DriftM(54.0), 1e-9);
  ASSERT_TRUE(far[0].wide());
  // All of the way out that lies within the reach of 2 m and the drift.
  EXPECT_EQ(far[0].surroundings, (std::vector<int>{0, 1, 2, 3}));
}

TEST(LoopCandidates, TheDriftHasABound) {
  const std::vector<LoopCandidate> candidates = Find(Loop(1000));
  ASSERT_FALSE(candidates.empty());
  EXPECT_DOUBLE_EQ(candidates.back().drift_m, 50.0);
}

TEST(LoopCandidates, AClosureShortensTheWay) {
  KeyframeGraph keys = Loop(50);
  // From 10 m to 48 m in 0.3 m: the way from 0 to 50 is 10 + 0.3 + 2.
  keys.closures.push_back({10, 48, Pose2(0.3, 0.0, 0.0), Eigen::Matrix3d::Identity()});
  const std::vector<LoopCandidate> candidates = Find(keys);
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_NEAR(candidates[0].drift_m, DriftM(12.3), 1e-9);
}

TEST(LoopCandidates, WhatIsClosedOrContradictedIsNotACandidateAgain) {
  const RelativePoseConstraint closure{0, 20, Pose2(1.5, 0.0, 0.0), Eigen::Matrix3d::Identity()};
  KeyframeGraph closed = Loop(20), contradicted = Loop(20);
  closed.closures.push_back(closure);
  contradicted.contradicted.push_back(closure);
  EXPECT_TRUE(Find(closed).empty());
  EXPECT_TRUE(Find(contradicted).empty());
}

TEST(LoopCandidates, AnUntrustedEdgeMakesItsTwoSidesCandidates) {
  KeyframeGraph keys;
  for (int i = 0; i < 8; ++i) Add({0.0, 1.0 * i, 0.0}, i, &keys);
  EXPECT_TRUE(Find(keys).empty());
  keys.sequential[3].evidence = 1.0;
  keys.sequential[3].in_question = true;
  const std::vector<LoopCandidate> candidates = Find(keys);
  ASSERT_FALSE(candidates.empty());
  for (const LoopCandidate& candidate : candidates) {
    EXPECT_TRUE(candidate.wide());
    EXPECT_LE(candidate.first, 3);
    EXPECT_GT(candidate.second, 3);
    EXPECT_GT(candidate.drift_m, 7.0);
    EXPECT_DOUBLE_EQ(candidate.drift_rad, 1.75);
  }
}

TEST(LoopCandidates, JoinsSpreadOverWhatLiesBeyondAnEdge) {
  KeyframeGraph keys;
  for (int i = 0; i < 40; ++i) Add({0.0, 1.0 * i, 0.0}, i, &keys);
  keys.sequential[9].in_question = true;
  keys.sequential[29].in_question = true;
  keys.sequential[29].evidence = 1.0;  // what lies beyond it is another part
  const std::vector<LoopCandidate> joins = FindJoins(keys, 9);
  ASSERT_EQ(joins.size(), 5u);  // 4 m apart
  for (std::size_t i = 0; i < joins.size(); ++i) {
    EXPECT_EQ(joins[i].first, 9);
    EXPECT_EQ(joins[i].second, 10 + 4 * static_cast<int>(i));
    EXPECT_EQ(joins[i].surroundings.size(), 10u);
    EXPECT_DOUBLE_EQ(joins[i].drift_rad, kPi);
    // The robot may have been turned round where it was carried to.
    EXPECT_GT(joins[i].drift_m, 7.0 + 2.0 * (1.0 + 4.0 * i));
  }
}

TEST(LoopCandidates, ATurnOfARadianCountsAsAMetre) {
  EXPECT_NEAR(ViewDistanceM(2.0, -0.5), 2.5, 1e-12);
  EXPECT_NEAR(ViewDistanceM(2.0, 2.0 * kPi - 0.5), 2.5, 1e-12);
}

TEST(LoopCandidates, OnePerVisitThatIsNearAndLongAgo) {
  KeyframeGraph keys;
  // Past the origin every 8 m of path, up to 2.5 m away in between; the way is short enough for
  // the search to be narrow.
  for (int i = 0; i <= 96; ++i) {
    Add({6.0 * std::sin(kPi * i / 32.0), 0.0, 0.0}, 0.25 * i, &keys);
  }
  int of_last = 0;
  for (const LoopCandidate& candidate : Find(keys)) {
    EXPECT_GE(keys.keyframes[candidate.second].path_m - keys.keyframes[candidate.first].path_m,
              6.0);
    of_last += candidate.second == 96 ? 1 : 0;
  }
  EXPECT_EQ(of_last, 3);  // at 0 m, 8 m and 16 m
}

TEST(LoopCandidates, ManyVisitsAreCappedAtTheNearestOnes) {
  KeyframeGraph keys;
  // Twenty laps of 12 m, closed to one another, and back at the start.
  for (int i = 0; i <= 480; ++i) {
    const double angle = kPi * i / 12.0;
    Add({2.0 * std::cos(angle), 2.0 * std::sin(angle), angle}, 0.5 * i, &keys);
    if (i >= 24) {
      keys.closures.push_back({i - 24, i, Pose2(), Eigen::Matrix3d::Identity()});
    }
  }
  int of_last = 0;
  for (const LoopCandidate& candidate : Find(keys)) of_last += candidate.second == 480 ? 1 : 0;
  EXPECT_GT(of_last, 0);
  EXPECT_LE(of_last, 4);
}

// Ten metres of path in each of two sessions, between which nothing was measured.
KeyframeGraph TwoSessions() {
  KeyframeGraph keys;
  for (int i = 0; i < 11; ++i) Add({1.0 * i, 0.0, 0.0}, i, &keys);
  for (int i = 0; i < 11; ++i) Add({1.0 * i, 0.5, 0.0}, 40.0 + i, &keys);
  keys.sequential[10].broken = keys.sequential[10].between_sessions = true;
  return keys;
}

TEST(LoopCandidates, NoWayLeadsFromOneSessionToAnotherButClosures) {
  KeyframeGraph keys = TwoSessions();
  EXPECT_TRUE(Find(keys).empty());
  keys.closures.push_back({5, 16, Pose2(0.0, 0.5, 0.0), Eigen::Matrix3d::Identity()});
  const std::vector<LoopCandidate> candidates = Find(keys);
  ASSERT_FALSE(candidates.empty());
  for (const LoopCandidate& candidate : candidates) {
    EXPECT_LT(candidate.first, 11);
    EXPECT_GE(candidate.second, 11);
    EXPECT_LE(candidate.drift_m, DriftM(14.0));  // of a way by the closure
  }
}

TEST(LoopCandidates, SessionsAreSoughtInSquaresOfWhatOthersSaw) {
  KeyframeGraph keys;
  for (int i = 0; i < 10; ++i) Add({1.0 * i, 0.0, 0.0}, i, &keys);
  for (int i = 10; i < 15; ++i) Add({100.0 + i, 0.0, 0.0}, i, &keys);
  for (int i = 15; i < 25; ++i) Add({500.0, 1.0 * i, 0.0}, 100.0 + i, &keys);
  const std::vector<LoopCandidate> joins = FindSessionJoins(keys, 15);
  // Two squares, and a keyframe every four metres.
  ASSERT_EQ(joins.size(), 6u);
  for (std::size_t i = 0; i < joins.size(); ++i) {
    EXPECT_TRUE(joins[i].unknown);
    EXPECT_DOUBLE_EQ(joins[i].drift_rad, kPi);
    EXPECT_EQ(joins[i].second, 15 + 4 * static_cast<int>(i % 3));
    EXPECT_EQ(joins[i].surroundings.size(), i < 3 ? 10u : 5u);
    // From the middle one to the last one, and as far as places overlap.
    EXPECT_NEAR(joins[i].drift_m, i < 3 ? 11.0 : 6.0, 1e-9);
  }
}

}  // namespace
}  // namespace plumbline
