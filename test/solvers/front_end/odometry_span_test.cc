#include "plumbline/solvers/front_end/odometry_span.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

const MotionOptions kOnlyFloors{0.0, 0.0, 0.0, 0.0, 0.1, 0.2};

// One metre ahead and a quarter turn to the left, then two metres ahead.
const std::vector<Pose2> kRoundACorner{Pose2(), {1.0, 0.0, 0.5 * kPi}, {2.0, 0.0, 0.0}};

TEST(OdometrySpan, ChainsTheSteps) {
  const OdometrySpan span = ChainOdometry(kRoundACorner, 0, 2, MotionOptions());
  EXPECT_NEAR(span.from_from_to.x, 1.0, 1e-12);
  EXPECT_NEAR(span.from_from_to.y, 2.0, 1e-12);
  EXPECT_NEAR(span.from_from_to.yaw, 0.5 * kPi, 1e-12);
}

TEST(OdometrySpan, AnEarlyTurnMovesAllThatFollows) {
  // The first heading's error of 0.2 rad acts on the arm of 2 m along y: 0.4 m against x.
  Eigen::Matrix3d expected;
  expected << 0.01 + 0.16 + 0.01, 0.0, -0.08, 0.0, 0.02, 0.0, -0.08, 0.0, 0.08;
  EXPECT_TRUE(ChainOdometry(kRoundACorner, 0, 2, kOnlyFloors).covariance.isApprox(expected, 1e-12));
}

TEST(OdometrySpan, AStepErrsInItsOwnDirection) {
  // A tenth of the length driven, and nothing else: 0.1 m along x, then 0.2 m along y.
  const MotionOptions along{0.0, 0.0, 0.1, 0.0, 0.0, 0.0};
  const Eigen::Matrix3d expected = Eigen::Vector3d(0.01, 0.04, 0.0).asDiagonal();
  EXPECT_TRUE(ChainOdometry(kRoundACorner, 0, 2, along).covariance.isApprox(expected, 1e-12));
}

TEST(OdometrySpan, TheStepToItsStartDoesNotCount) {
  const OdometrySpan span = ChainOdometry(kRoundACorner, 1, 2, kOnlyFloors);
  EXPECT_EQ(span.from_from_to.x, 2.0);
  EXPECT_EQ(span.from_from_to.yaw, 0.0);
  const Eigen::Matrix3d expected = Eigen::Vector3d(0.01, 0.01, 0.04).asDiagonal();
  EXPECT_TRUE(span.covariance.isApprox(expected, 1e-12));
  EXPECT_TRUE(ChainOdometry(kRoundACorner, 2, 2, kOnlyFloors).covariance.isZero());
}

TEST(OdometrySpan, FindsTheStepToEachPose) {
  SlamGraph graph;
  for (int i = 0; i < 3; ++i) graph.AddPose(Pose2(), i);
  graph.AddOdometry({1, 2, Pose2()});
  graph.AddOdometry({0, 2, Pose2()});  // no step
  std::vector<int> steps;
  const Status missing = FindOdometrySteps(graph, &steps);
  EXPECT_EQ(missing.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(missing.message().find("from pose 0 to pose 1"), std::string::npos);
  graph.AddOdometry({0, 1, Pose2()});
  ASSERT_TRUE(FindOdometrySteps(graph, &steps).ok());
  EXPECT_EQ(steps, (std::vector<int>{-1, 2, 0}));
}

}  // namespace
}  // namespace plumbline
