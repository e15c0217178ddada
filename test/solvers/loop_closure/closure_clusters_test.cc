#include "plumbline/solvers/loop_closure/closure_clusters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/test/solvers/loop_closure/corridor.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

TEST(FindClosureClusters, DividesByPathAndByPlace) {
  const KeyframeGraph keys = Corridor();
  // Two closures of one stretch with one place, one of it with another place, and one later.
  const std::vector<RelativePoseConstraint> closures = {Closure(20, 62), Closure(4, 61),
                                                        Closure(18, 60), Closure(1, 79)};
  EXPECT_THAT(FindClosureClusters(closures, keys),
              ElementsAre(ElementsAre(2, 0), ElementsAre(1), ElementsAre(3)));
  EXPECT_TRUE(FindClosureClusters({}, keys).empty());
}

TEST(FindClosureClusters, AreNoLongerThanAStretch) {
  const KeyframeGraph keys = Corridor();
  std::vector<RelativePoseConstraint> closures;
  for (int to = 50; to <= 75; ++to) closures.push_back(Closure(20, to));
  const std::vector<ClosureCluster> clusters = FindClosureClusters(closures, keys);
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_EQ(clusters[0].size(), 13u);  // 12 m
}

TEST(RepeatsOneOf, KnowsTheSamePlaceFromNeighbouringKeyframes) {
  const KeyframeGraph keys = Corridor();
  const Pose2 wrong(3.0, 0.0, 0.0);
  const std::vector<RelativePoseConstraint> refused = {Closure(20, 60, wrong)};
  EXPECT_TRUE(RepeatsOneOf(Closure(20, 60, wrong), refused, keys));
  // Two metres further on, the place is two metres back.
  EXPECT_TRUE(RepeatsOneOf(Closure(18, 62, wrong), refused, keys));
  EXPECT_FALSE(RepeatsOneOf(Closure(20, 60), refused, keys));        // elsewhere
  EXPECT_FALSE(RepeatsOneOf(Closure(4, 76, wrong), refused, keys));  // later
  EXPECT_FALSE(RepeatsOneOf(Closure(20, 60, wrong), {}, keys));
}

TEST(WithoutRepetitions, KeepsTheFirstOfEachPlace) {
  const KeyframeGraph keys = Corridor();
  const Pose2 wrong(3.0, 0.0, 0.0);
  const std::vector<RelativePoseConstraint> closures = {
      Closure(15, 65, wrong), Closure(20, 60, wrong), Closure(2, 78), Closure(20, 60)};
  const std::vector<RelativePoseConstraint> kept = WithoutRepetitions(closures, 8, keys);
  ASSERT_EQ(kept.size(), 3u);
  EXPECT_EQ(kept[0].to, 65);
  EXPECT_EQ(kept[1].to, 78);
  EXPECT_EQ(kept[2].from_from_to.x, 0.0);  // the same keyframes, elsewhere
  EXPECT_EQ(WithoutRepetitions(closures, 2, keys).size(), 2u);
}

}  // namespace
}  // namespace plumbline
