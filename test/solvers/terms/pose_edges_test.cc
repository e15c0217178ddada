#include "plumbline/solvers/terms/pose_edges.h"

#include <gtest/gtest.h>

#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

TEST(PoseEdgesTest, AreTheConstraintsOfTheGraph) {
  SlamGraph graph;
  for (const Pose2& pose : {Pose2(1.0, 2.0, 0.5), Pose2(2.0, 2.0, 0.5), Pose2(2.0, 3.0, 1.0)}) {
    graph.AddPose(pose, 0.0);
  }
  graph.AddOdometry({0, 1, {1.0, 0.0, 0.1}});
  graph.AddOdometry({1, 2, {0.5, 0.0, 0.1}});
  graph.AddRelativePose({2, 0, {-1.0, 0.5, 0.0}, CorrelatedCovariance()});
  const PoseEdges edges(graph, FactorOptions());
  ASSERT_EQ(edges.motions.size(), 2u);
  EXPECT_EQ(edges.motions[1].from, 1);
  EXPECT_EQ(edges.motions[1].to, 2);
  EXPECT_EQ(edges.motions[1].residual.a_from_b.x, 0.5);
  ASSERT_EQ(edges.relative_poses.size(), 1u);
  EXPECT_EQ(edges.relative_poses[0].from, 2);
  EXPECT_EQ(edges.relative_poses[0].to, 0);
}

TEST(PoseEdgesTest, AnIgnoredRelativePoseSaysNextToNothing) {
  SlamGraph graph;
  for (const double x : {0.0, 1.0, 2.0}) graph.AddPose({x, 0.0, 0.0}, x);
  graph.AddRelativePose({0, 1, {1.0, 0.0, 0.0}, CorrelatedCovariance()});
  graph.AddRelativePose({1, 2, {1.0, 0.0, 0.0}, CorrelatedCovariance()});
  FactorOptions options;
  options.ignored_relative_poses = {1, 7};  // of which there is one
  const PoseEdges plain(graph, FactorOptions()), ignoring(graph, options);
  const auto information = [](const PoseEdges& edges, int i) {
    return Eigen::Matrix3d(edges.relative_poses[i].residual.sqrt_information);
  };
  EXPECT_EQ(information(ignoring, 0), information(plain, 0));
  EXPECT_TRUE((kIgnoredSigmaFactor * information(ignoring, 1)).isApprox(information(plain, 1)));
}

}  // namespace
}  // namespace plumbline
