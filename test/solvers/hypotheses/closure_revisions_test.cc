#include "plumbline/solvers/hypotheses/closure_revisions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/test/solvers/loop_closure/corridor.h"

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

const Pose2 kWrong(3.0, 0.0, 0.0);

TEST(WithRepetitions, AddsWhatSaysTheSameNearBy) {
  KeyframeGraph keys = Corridor();
  keys.closures = {Closure(20, 60, kWrong), Closure(15, 65, kWrong),  // says the same
                   Closure(14, 66),                                   // something else
                   Closure(2, 78, kWrong)};                           // far from it
  const std::vector<Revision> repeated = WithRepetitions({{keys.closures[0]}}, keys);
  ASSERT_THAT(repeated, SizeIs(1));
  ASSERT_THAT(repeated[0], SizeIs(2));
  EXPECT_EQ(repeated[0][0].to, 60);
  EXPECT_EQ(repeated[0][1].to, 65);
}

TEST(WithRepetitions, LeavesOutClustersThatStandAlone) {
  KeyframeGraph keys = Corridor();
  keys.closures = {Closure(20, 60, kWrong), Closure(18, 62, kWrong), Closure(14, 66)};
  EXPECT_THAT(WithRepetitions({{keys.closures[0], keys.closures[1]}, {keys.closures[2]}}, keys),
              IsEmpty());
}

TEST(Without, RefusesTheClusterAndGivesWhatItContradictedAnotherChance) {
  KeyframeGraph keys = Corridor();
  keys.closures = {Closure(20, 60, kWrong), Closure(2, 78)};
  keys.contradicted = {Closure(18, 62), Closure(18, 62, kWrong)};
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
