#include "plumbline/solvers/loop_closure/closure_memory.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// Keyframes one metre apart on a straight line.
KeyframeGraph Line() {
  KeyframeGraph keys;
  for (int k = 0; k <= 30; ++k) {
    Keyframe key;
    key.path_m = k;
    keys.keyframes.push_back(key);
    keys.world_from_key.emplace_back(k, 0.0, 0.0);
  }
  return keys;
}

LoopCandidate Candidate(double drift_m) { return {5, 20, drift_m, 0.2, {}}; }

TestedCandidate Match(const KeyframeGraph& keys, const Pose2& off) {
  TestedCandidate tested;
  tested.outcome = ClosureOutcome::kAccepted;
  tested.edge.from = 5;
  tested.edge.to = 20;
  tested.edge.from_from_to = Between(keys.world_from_key[5], keys.world_from_key[20]) * off;
  return tested;
}

TEST(ClosureMemory, KnowsNothingAtFirst) {
  EXPECT_EQ(ClosureMemory().Find(Candidate(1.0), Line()), nullptr);
}

TEST(ClosureMemory, ANarrowerWindowHoldsNoMoreMatches) {
  const KeyframeGraph keys = Line();
  ClosureMemory memory;
  memory.Add(Candidate(3.0), keys, TestedCandidate());
  ASSERT_NE(memory.Find(Candidate(1.0), keys), nullptr);
  EXPECT_EQ(memory.Find(Candidate(1.0), keys)->outcome, ClosureOutcome::kNoMatch);
  EXPECT_EQ(memory.Find(Candidate(6.0), keys), nullptr);
}

TEST(ClosureMemory, AMatchCountsWhereItLiesWithinTheWindow) {
  const KeyframeGraph keys = Line();
  ClosureMemory memory;
  memory.Add(Candidate(3.0), keys, Match(keys, Pose2(2.0, 0.0, 0.0)));
  ASSERT_NE(memory.Find(Candidate(2.5), keys), nullptr);
  EXPECT_EQ(memory.Find(Candidate(2.5), keys)->outcome, ClosureOutcome::kAccepted);
  // Another, less good one may lie in this window.
  EXPECT_EQ(memory.Find(Candidate(1.0), keys), nullptr);
}

TEST(ClosureMemory, AWindowThatMovedAwayIsNew) {
  KeyframeGraph keys = Line();
  ClosureMemory memory;
  memory.Add(Candidate(1.0), keys, TestedCandidate());
  keys.world_from_key[20].y += 4.0;
  EXPECT_EQ(memory.Find(Candidate(1.0), keys), nullptr);
  // All that moves along stays.
  for (Pose2& pose : keys.world_from_key) pose = Pose2(3.0, -2.0, 1.0) * pose;
  keys.world_from_key[20] = keys.world_from_key[20] * Pose2(0.0, -4.0, 0.0);
  EXPECT_NE(memory.Find(Candidate(1.0), keys), nullptr);
}

TEST(ClosureMemory, AWideSearchLooksAtItsSurroundings) {
  const KeyframeGraph keys = Line();
  LoopCandidate wide{5, 20, 10.0, 0.5, {3, 4, 5, 6, 7}};
  ClosureMemory memory;
  memory.Add(wide, keys, TestedCandidate());
  EXPECT_NE(memory.Find(wide, keys), nullptr);
  EXPECT_EQ(memory.Find(Candidate(3.0), keys), nullptr);  // a narrow one is of another map
  wide.surroundings = {0, 1, 2, 3, 4, 5, 6, 7};           // more to be found
  EXPECT_EQ(memory.Find(wide, keys), nullptr);
}

}  // namespace
}  // namespace plumbline
