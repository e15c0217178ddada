#include "plumbline/solvers/loop_closure/closure_revisions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

// A straight corridor there and back, a keyframe per metre.
KeyframeGraph Corridor() {
  KeyframeGraph keys;
  for (int k = 0; k <= 80; ++k) {
    Keyframe key;
    key.pose = key.scan = k;
    key.path_m = k;
    keys.keyframes.push_back(key);
    keys.world_from_key.emplace_back(k <= 40 ? k : 80.0 - k, 0.0, 0.0);
  }
  return keys;
}

RelativePoseConstraint Closure(int from, int to, double off_m) {
  RelativePoseConstraint closure;
  closure.from = from;
  closure.to = to;
  closure.from_from_to = Pose2(off_m, 0.0, 0.0);
  return closure;
}

TEST(WithRepetitions, AddsWhatSaysTheSameNearBy) {
  KeyframeGraph keys = Corridor();
  keys.closures = {Closure(20, 60, 3.0), Closure(15, 65, 3.0),  // says the same
                   Closure(14, 66, 0.0),                        // something else
                   Closure(2, 78, 3.0)};                        // far from it
  const std::vector<Revision> repeated = WithRepetitions({{keys.closures[0]}}, keys);
  ASSERT_THAT(repeated, SizeIs(1));
  ASSERT_THAT(repeated[0], SizeIs(2));
  EXPECT_EQ(repeated[0][0].to, 60);
  EXPECT_EQ(repeated[0][1].to, 65);
}

TEST(WithRepetitions, LeavesOutClustersThatStandAlone) {
  KeyframeGraph keys = Corridor();
  keys.closures = {Closure(20, 60, 3.0), Closure(18, 62, 3.0), Closure(14, 66, 0.0)};
  EXPECT_THAT(WithRepetitions({{keys.closures[0], keys.closures[1]}, {keys.closures[2]}}, keys),
              IsEmpty());
}

TEST(Without, RefusesTheClusterAndGivesWhatItContradictedAnotherChance) {
  KeyframeGraph keys = Corridor();
  keys.closures = {Closure(20, 60, 3.0), Closure(2, 78, 0.0)};
  keys.contradicted = {Closure(18, 62, 0.0), Closure(18, 62, 3.0)};
  const KeyframeGraph without = Without({keys.closures[0]}, keys);
  ASSERT_THAT(without.refused, SizeIs(1));
  EXPECT_EQ(without.refused[0].to, 60);
  ASSERT_THAT(without.closures, SizeIs(2));
  EXPECT_EQ(without.closures[0].to, 78);
  EXPECT_EQ(without.closures[1].from_from_to.x, 0.0);
  EXPECT_THAT(without.contradicted, IsEmpty());
}

}  // namespace
}  // namespace plumbline
