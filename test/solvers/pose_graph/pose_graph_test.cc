#include "plumbline/solvers/pose_graph/pose_graph.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

RelativePoseConstraint Edge(int from, int to, const Pose2& motion, double sigma) {
  return {from, to, motion, sigma * sigma * Eigen::Matrix3d::Identity()};
}

TEST(PoseGraph, SpreadsTheErrorOfALoopOverItsEdges) {
  const std::vector<RelativePoseConstraint> chain{Edge(0, 1, {1.0, 0.0, 0.0}, 1.0),
                                                  Edge(1, 2, {1.0, 0.0, 0.0}, 1.0)};
  std::vector<Pose2> poses{{5.0, 7.0, 0.0}, {6.0, 7.0, 0.0}, {7.0, 7.0, 0.0}};
  // Three equal edges share 0.03 sigma of error, where the Cauchy loss is still quadratic.
  OptimizePoseGraph(chain, {Edge(0, 2, {2.03, 0.0, 0.0}, 1.0)}, &poses);
  EXPECT_EQ(poses[0].x, 5.0);
  EXPECT_NEAR(poses[1].x, 6.01, 1e-5);
  EXPECT_NEAR(poses[2].x, 7.02, 1e-5);
  EXPECT_NEAR(poses[2].y, 7.0, 1e-9);
}

TEST(PoseGraph, AWrongClosureIsOutvoted) {
  std::vector<RelativePoseConstraint> chain;
  std::vector<Pose2> poses{Pose2()};
  for (int i = 0; i < 20; ++i) {
    chain.push_back(Edge(i, i + 1, {1.0, 0.0, 0.0}, 0.01));
    poses.emplace_back(i + 1.0, 0.0, 0.0);
  }
  const RelativePoseConstraint wrong = Edge(0, 20, {15.0, 0.0, 0.0}, 0.01);
  OptimizePoseGraph(chain, {Edge(0, 20, {20.0, 0.0, 0.0}, 0.01), wrong}, &poses);
  EXPECT_NEAR(poses[20].x, 20.0, 0.02);
  EXPECT_GT(EdgeChi2(wrong, poses), 1e4);
}

// The chain knows its end to 1 m, the closure is 8 m and 800 of its own standard deviations off: a
// loss that is narrow from the start would leave it where it is.
TEST(PoseGraph, ARightClosureFarOffPullsTheLoopShut) {
  std::vector<RelativePoseConstraint> chain;
  std::vector<Pose2> poses{Pose2()};
  for (int i = 0; i < 100; ++i) {
    chain.push_back(Edge(i, i + 1, {1.0, 0.0, 0.0}, 0.1));
    poses.emplace_back(i + 1.0, 0.0, 0.0);
  }
  const RelativePoseConstraint closure = Edge(0, 100, {108.0, 0.0, 0.0}, 0.01);
  OptimizePoseGraph(chain, {closure}, &poses);
  // The closure keeps 0.01^2 / (1^2 + 0.01^2) of the 8 m, the edges share the rest.
  EXPECT_NEAR(poses[100].x, 108.0 - 8e-4, 1e-4);
  EXPECT_NEAR(poses[50].x, 54.0, 1e-3);
  EXPECT_NEAR(poses[50].y, 0.0, 1e-6);
}

TEST(PoseGraph, HoldsTheFixedPoses) {
  // Both ends are fixed 3 m apart, the two edges in between say 1 m each: the gap is shared.
  std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {0.4, 0.1, 0.0}, {3.0, 0.0, 0.0}};
  const PoseGraphResult result = OptimizePoseGraph(
      {Edge(0, 1, {1.0, 0.0, 0.0}, 0.1), Edge(1, 2, {1.0, 0.0, 0.0}, 0.1)}, {}, &poses, {0, 2});
  EXPECT_TRUE(result.converged) << result.stop_reason;
  EXPECT_GT(result.iterations, 0);
  EXPECT_EQ(poses[0].x, 0.0);
  EXPECT_EQ(poses[2].x, 3.0);
  EXPECT_NEAR(poses[1].x, 1.5, 1e-5);
  EXPECT_NEAR(poses[1].y, 0.0, 1e-5);
}

TEST(PoseGraph, Chi2IsTheSquaredMahalanobisLength) {
  RelativePoseConstraint edge = Edge(0, 1, {1.0, 0.0, kPi}, 1.0);
  edge.covariance = Eigen::Vector3d(0.04, 0.25, 0.01).asDiagonal();
  // Frame 0 looks along y: the error is (0.2, -1.0, 0.1) there, across the wrap of the angle.
  const std::vector<Pose2> poses{{0.0, 0.0, kPi / 2.0}, {1.0, 1.2, -kPi / 2.0 + 0.1}};
  EXPECT_NEAR(EdgeChi2(edge, poses), 1.0 + 4.0 + 1.0, 1e-9);
  EXPECT_NEAR(GraphChi2({edge, edge, edge}, poses), 18.0, 1e-9);
}

// What a closure that was dropped since has bent.
TEST(PoseGraph, StraightensAChainWithoutClosures) {
  std::vector<Pose2> poses{Pose2(), {1.1, 0.1, 0.2}, {2.0, 0.3, 0.1}};
  OptimizePoseGraph({Edge(0, 1, {1.0, 0.0, 0.0}, 0.01), Edge(1, 2, {1.0, 0.0, 0.0}, 0.01)}, {},
                    &poses);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(poses[i].x, i, 1e-6);
    EXPECT_NEAR(poses[i].y, 0.0, 1e-6);
    EXPECT_NEAR(poses[i].yaw, 0.0, 1e-6);
  }
}

TEST(PoseGraph, LeavesPosesWithoutEdgesAsTheyAre) {
  std::vector<Pose2> none, poses{{1.0, 2.0, 3.0}};
  OptimizePoseGraph({}, {}, &none);
  OptimizePoseGraph({}, {}, &poses);
  EXPECT_EQ(poses[0].y, 2.0);
}

TEST(PoseGraph, KnowsTheDirectionInWhichAnEdgeIsKnownWorst) {
  RelativePoseConstraint edge = Edge(0, 1, Pose2(), 0.01);
  const Eigen::Vector2d along(0.6, 0.8);
  edge.covariance.topLeftCorner<2, 2>() += (0.25 - 1e-4) * along * along.transpose();
  edge.covariance(2, 2) = 4.0;
  EXPECT_NEAR(WorstSigmaM(edge), 0.5, 1e-12);
}

}  // namespace
}  // namespace plumbline
