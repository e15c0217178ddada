#include "plumbline/solvers/pose_graph/connected_poses.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// Poses 0 and 4, 1 and 3, and 2 alone.
SlamGraph ThreeGroups() {
  SlamGraph graph;
  for (int i = 0; i < 5; ++i) graph.AddPose(Pose2(), i);
  RelativePoseConstraint edge;
  edge.from = 4;
  graph.AddRelativePose(edge);
  edge.from = 1;
  edge.to = 3;
  graph.AddRelativePose(edge);
  graph.AddOdometry({1, 2, Pose2()});  // connects nothing
  return graph;
}

TEST(ConnectedPosesTest, FindsTheFirstPoseBeyondTheAnchors) {
  const SlamGraph graph = ThreeGroups();
  EXPECT_EQ(FindUnconnectedPose(graph, {0}), 1);
  EXPECT_EQ(FindUnconnectedPose(graph, {3, 4}), 2);
  EXPECT_EQ(FindUnconnectedPose(graph, {1, 2}), 0);
  EXPECT_EQ(FindUnconnectedPose(graph, {2, 3, 0}), -1);
  EXPECT_EQ(FindUnconnectedPose(graph, {}), 0);
  EXPECT_EQ(FindUnconnectedPose(SlamGraph(), {}), -1);
}

}  // namespace
}  // namespace plumbline
