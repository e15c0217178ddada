#include "plumbline/solvers/pose_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "plumbline/factors/motion_factor.h"
#include "plumbline/test/factor_testing.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

TEST(PoseTermsTest, HoldsEveryConstraintOfTheGraph) {
  SlamGraph graph;
  int id = 0;
  for (const Pose2& pose : {Pose2(1.0, 2.0, 0.5), Pose2(2.0, 2.0, 0.5), Pose2(2.0, 3.0, 1.0)}) {
    ASSERT_TRUE(graph.AddPose(pose, 0.0, &id).ok());
  }
  ASSERT_TRUE(graph.AddOdometry({0, 1, {1.0, 0.0, 0.1}}).ok());
  ASSERT_TRUE(graph.AddOdometry({1, 2, {0.5, 0.0, 0.1}}).ok());
  ASSERT_TRUE(graph.AddRelativePose({2, 0, {-1.0, 0.5, 0.0}, CorrelatedCovariance()}).ok());
  const PoseTerms terms(graph, FactorOptions());
  EXPECT_THAT(terms.is_constant, ElementsAre(true, false, false));
  ASSERT_EQ(terms.motions.size(), 2u);
  EXPECT_EQ(terms.motions[1].from, 1);
  EXPECT_EQ(terms.motions[1].to, 2);
  EXPECT_EQ(terms.motions[1].residual.a_from_b.x, 0.5);
  ASSERT_EQ(terms.relative_poses.size(), 1u);
  EXPECT_EQ(terms.relative_poses[0].from, 2);
  EXPECT_EQ(terms.relative_poses[0].to, 0);
}

TEST(PoseTermsTest, CostIsHalfTheSumOfSquaredMahalanobisDistances) {
  SlamGraph graph;
  int id = 0;
  ASSERT_TRUE(graph.AddPose({0.0, 0.0, 0.0}, 0.0, &id).ok());
  ASSERT_TRUE(graph.AddPose({1.0, 0.0, 0.0}, 1.0, &id).ok());
  const Pose2 step(0.9, 0.1, 0.05);
  ASSERT_TRUE(graph.AddOdometry({0, 1, step}).ok());
  const Pose2 measured(1.2, -0.1, 0.02);
  ASSERT_TRUE(graph.AddRelativePose({0, 1, measured, CorrelatedCovariance()}).ok());
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
  int id = 0;
  for (const double x : {0.0, 1.0, 2.0}) ASSERT_TRUE(graph.AddPose({x, 0.0, 0.0}, 0.0, &id).ok());
  ASSERT_TRUE(graph.FixPose(1).ok());
  ASSERT_TRUE(graph.FixPose(2).ok());
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
