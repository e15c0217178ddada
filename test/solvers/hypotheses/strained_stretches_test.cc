#include "plumbline/solvers/hypotheses/strained_stretches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/solvers/loop_closure/loop_acceptance.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;

auto IsStretch(int first, int end, int num_closures_inside) {
  return AllOf(Field(&StretchOfSteps::first, first), Field(&StretchOfSteps::end, end),
               Field(&StretchOfSteps::num_closures_inside, num_closures_inside));
}

// Six keyframes a metre apart, each edge with sigmas of 0.1. The step before keyframe 3 is two
// sigmas off; a closure leads from keyframe 4 back to keyframe 1.
KeyframeGraph SixKeys() {
  KeyframeGraph keys;
  for (int k = 0; k < 6; ++k) {
    keys.keyframes.emplace_back();
    keys.world_from_key.push_back({1.0 * k, 0.0, 0.0});
    if (k == 0) continue;
    SequentialEdge edge;
    edge.constraint.from = k - 1;
    edge.constraint.to = k;
    edge.constraint.from_from_to = {k == 3 ? 1.2 : 1.0, 0.0, 0.0};
    edge.constraint.covariance = 0.01 * Eigen::Matrix3d::Identity();
    keys.sequential.push_back(edge);
  }
  RelativePoseConstraint closure = keys.sequential[0].constraint;
  closure.from = 1;
  closure.to = 4;
  closure.from_from_to = {3.0, 0.0, 0.0};
  closure.covariance = 0.05 * 0.05 * Eigen::Matrix3d::Identity();
  keys.closures.push_back(closure);
  return keys;
}

TEST(StrainedStretches, LieBetweenTheEndsOfClosures) {
  EXPECT_THAT(StretchesBetweenClosures(SixKeys()),
              ElementsAre(IsStretch(0, 1, 0), IsStretch(1, 4, 0)));
}

TEST(StrainedStretches, GoOnWhereAClosureIsHardlyKnownInOneDirection) {
  KeyframeGraph keys = SixKeys();
  RelativePoseConstraint along = keys.closures.front();
  along.from = 2;
  along.covariance(1, 1) = 0.3 * 0.3;
  keys.closures.push_back(along);
  along.to = 3;
  keys.closures.push_back(along);
  EXPECT_THAT(StretchesBetweenClosures(keys), ElementsAre(IsStretch(0, 1, 0), IsStretch(1, 4, 2)));
}

TEST(StrainedStretches, ReachToTheLastClosureOfAnyKind) {
  KeyframeGraph keys = SixKeys();
  keys.closures.front().covariance(1, 1) = 0.3 * 0.3;
  EXPECT_THAT(StretchesBetweenClosures(keys), ElementsAre(IsStretch(0, 4, 1)));
}

TEST(StrainedStretches, NeedKeyframesAndClosures) {
  EXPECT_THAT(StretchesBetweenClosures(KeyframeGraph()), ElementsAre());
  KeyframeGraph keys = SixKeys();
  keys.closures.clear();
  EXPECT_THAT(StretchesBetweenClosures(keys), ElementsAre());
}

TEST(StrainedStretches, EndWhereASessionDoes) {
  KeyframeGraph keys = SixKeys();
  keys.sequential[2].between_sessions = true;
  EXPECT_THAT(StretchesBetweenClosures(keys), ElementsAre(IsStretch(0, 1, 0), IsStretch(1, 2, 0),
                                                          IsStretch(2, 3, 0), IsStretch(3, 4, 0)));
}

TEST(StrainedStretches, AreOffByWhatTheirEdgesAreButBrokenOnes) {
  KeyframeGraph keys = SixKeys();
  EXPECT_NEAR(StepsChi2(keys, 1, 4), 4.0, 1e-9);
  EXPECT_NEAR(StepsChi2(keys, 3, 5), 0.0, 1e-9);
  keys.sequential[2].broken = true;
  EXPECT_NEAR(StepsChi2(keys, 1, 4), 0.0, 1e-9);
}

TEST(StrainedStretches, MayBeOffByLessWhereTheRestIsLessOff) {
  KeyframeGraph keys = SixKeys();
  EXPECT_NEAR(GraphChi2(keys), 4.0, 1e-9);
  // Four squared sigmas for three degrees of freedom: as much as covariances allow.
  EXPECT_NEAR(MostStrain(4.0, 1, 0), LoopAcceptance::kMaxEdgeChi2, 1e-9);
  EXPECT_NEAR(MostStrain(1.0, 1, 0), LoopAcceptance::kMaxEdgeChi2 / 3.0, 1e-9);
  // A hundredth of what the covariances allow is always granted.
  EXPECT_NEAR(MostStrain(0.0, 1, 0), 0.01 * LoopAcceptance::kMaxEdgeChi2, 1e-9);
  // Two closures inside are worth three degrees of freedom each.
  EXPECT_NEAR(MostStrain(1.0, 1, 2), (LoopAcceptance::kMaxEdgeChi2 + 6.0) / 3.0, 1e-9);
}

}  // namespace
}  // namespace plumbline
