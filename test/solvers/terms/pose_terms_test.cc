#include "plumbline/solvers/terms/pose_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "plumbline/factors/motion_factor.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

TEST(PoseTermsTest, HoldsEveryConstraintOfTheGraph) {
  SlamGraph graph;
  for (const Pose2& pose : {Pose2(1.0, 2.0, 0.5), Pose2(2.0, 2.0, 0.5), Pose2(2.0, 3.0, 1.0)}) {
    graph.AddPose(pose, 0.0);
  }
  graph.AddOdometry({0, 1, {1.0, 0.0, 0.1}});
  graph.AddOdometry({1, 2, {0.5, 0.0, 0.1}});
  graph.AddRelativePose({2, 0, {-1.0, 0.5, 0.0}, CorrelatedCovariance()});
  const PoseTerms terms(graph, FactorOptions());
  EXPECT_THAT(terms.is_constant, ElementsAre(true, false, false));
  ASSERT_EQ(terms.terms.size(), 2u);
  EXPECT_EQ(terms.terms[0]->name(), "motion");
  EXPECT_EQ(terms.terms[0]->num_blocks(), 2u);
  EXPECT_EQ(terms.terms[1]->name(), "relative pose");
  EXPECT_EQ(terms.terms[1]->num_blocks(), 1u);
}

TEST(PoseTermsTest, CostIsHalfTheSumOfSquaredMahalanobisDistances) {
  SlamGraph graph;
  graph.AddPose({0.0, 0.0, 0.0}, 0.0);
  graph.AddPose({1.0, 0.0, 0.0}, 1.0);
  const Pose2 step(0.9, 0.1, 0.05);
  graph.AddOdometry({0, 1, step});
  const Pose2 measured(1.2, -0.1, 0.02);
  graph.AddRelativePose({0, 1, measured, CorrelatedCovariance()});
  const FactorOptions factors;
  const PoseTerms terms(graph, factors);

  // Both stand parallel to the axes.
  const double distance_m = 0.7;
  const auto mahalanobis = [](const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
    return error.dot(covariance.inverse() * error);
  };
  const double expected = 0.5 * (mahalanobis({distance_m - step.x, -step.y, -step.yaw},
                                             MotionCovariance(step, factors.motion)) +
                                 mahalanobis({distance_m - measured.x, -measured.y, -measured.yaw},
                                             CorrelatedCovariance()));
  EXPECT_NEAR(terms.Cost({0.3, 0.0, 0.0, 1.0, 0.0, 0.0}), expected, 1e-9 * expected);
}

TEST(PoseTermsTest, FixedPosesAreConstantsAndCostNothing) {
  SlamGraph graph;
  for (const double x : {0.0, 1.0, 2.0}) graph.AddPose({x, 0.0, 0.0}, 0.0);
  graph.FixPose(1);
  graph.FixPose(2);
  const PoseTerms terms(graph, FactorOptions());
  EXPECT_THAT(terms.is_constant, ElementsAre(false, true, true));
  EXPECT_EQ(terms.Cost({5.0, 5.0, 5.0, 1.0, 0.1, 0.0, 2.0, 0.0, 0.3}), 0.0);
}

TEST(PoseTermsTest, AnEmptyGraphCostsNothing) {
  const PoseTerms terms{SlamGraph(), FactorOptions()};
  EXPECT_TRUE(terms.is_constant.empty());
  EXPECT_EQ(terms.Cost({}), 0.0);
}

}  // namespace
}  // namespace plumbline
