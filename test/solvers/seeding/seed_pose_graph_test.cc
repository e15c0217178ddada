#include "plumbline/solvers/seeding/seed_pose_graph.h"

#include <gtest/gtest.h>

#include <vector>

#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

// Ten poses along a bend; the keyframes are poses 1, 5 and 8.
class SeedPoseGraphTest : public testing::Test {
 protected:
  SeedPoseGraphTest() {
    Pose2 pose(3.0, -2.0, 1.0);
    for (int i = 0; i < 10; ++i) {
      trajectory_.world_from_robot.push_back(pose);
      trajectory_.odometry.emplace_back(0.2, 0.0, 0.3);
      pose = pose * Pose2(0.2 + 0.01 * i, 0.02, 0.3);
    }
    for (const int key : {1, 5, 8}) {
      Keyframe scan;
      scan.pose = key;
      keys_.keyframes.push_back(scan);
      keys_.world_from_key.push_back(trajectory_.world_from_robot[key]);
    }
    for (int k = 0; k < 2; ++k) {
      const Pose2 motion = Between(keys_.world_from_key[k], keys_.world_from_key[k + 1]);
      SequentialEdge edge;
      edge.constraint = {k, k + 1, motion, (k + 1.0) * CorrelatedCovariance()};
      keys_.sequential.push_back(edge);
    }
  }

  std::vector<RelativePoseConstraint> Graph() const {
    return SeedPoseGraph(keys_, trajectory_, motion_);
  }

  // Covariance of a chain of edges in the frame of its first pose, to first order.
  static Eigen::Matrix3d Chained(const std::vector<RelativePoseConstraint>& edges, int from,
                                 int to) {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    Pose2 chained;
    for (int i = from; i < to; ++i) {
      const Eigen::Vector2d arm =
          Pose2(0.0, 0.0, chained.yaw) * edges[i].from_from_to.translation();
      Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
      carried(0, 2) = -arm.y();
      carried(1, 2) = arm.x();
      covariance =
          carried * covariance * carried.transpose() + RotateAxes(edges[i].covariance, chained.yaw);
      chained = chained * edges[i].from_from_to;
    }
    return covariance;
  }

  KeyframeGraph keys_;
  SequentialTrajectory trajectory_;
  const MotionOptions motion_;
};

TEST_F(SeedPoseGraphTest, ChainsEveryPoseToTheNext) {
  const std::vector<RelativePoseConstraint> edges = Graph();
  ASSERT_EQ(edges.size(), 9u);
  Pose2 pose = trajectory_.world_from_robot[0];
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(edges[i].from, i);
    EXPECT_EQ(edges[i].to, i + 1);
    pose = pose * edges[i].from_from_to;
    EXPECT_NEAR(pose.x, trajectory_.world_from_robot[i + 1].x, 1e-12);
    EXPECT_NEAR(pose.y, trajectory_.world_from_robot[i + 1].y, 1e-12);
  }
}

TEST_F(SeedPoseGraphTest, TheStepsBetweenKeyframesAddUpToTheirEdge) {
  const std::vector<RelativePoseConstraint> edges = Graph();
  EXPECT_TRUE(Chained(edges, 1, 5).isApprox(keys_.sequential[0].constraint.covariance, 1e-9));
  EXPECT_TRUE(Chained(edges, 5, 8).isApprox(keys_.sequential[1].constraint.covariance, 1e-9));
  for (const RelativePoseConstraint& edge : edges) {
    EXPECT_TRUE(edge.covariance.isApprox(edge.covariance.transpose(), 0.0));
    EXPECT_EQ(edge.covariance.llt().info(), Eigen::Success);
  }
}

TEST_F(SeedPoseGraphTest, OutsideTheKeyframesTheOdometryCounts) {
  const std::vector<RelativePoseConstraint> edges = Graph();
  const Eigen::Matrix3d noise = MotionCovariance({0.2, 0.0, 0.3}, motion_);
  EXPECT_EQ(edges[0].covariance, noise);
  EXPECT_EQ(edges[8].covariance, noise);
  keys_ = KeyframeGraph();
  EXPECT_EQ(Graph()[4].covariance, noise);
}

TEST_F(SeedPoseGraphTest, ABrokenEdgeGivesWayAtItsBreak) {
  const std::vector<RelativePoseConstraint> sound = Graph();
  keys_.sequential[0].evidence = 1.0;
  keys_.sequential[0].broken = true;
  keys_.sequential[0].first_pose_after = 4;
  const std::vector<RelativePoseConstraint> edges = Graph();
  EXPECT_EQ(edges[3].covariance, keys_.sequential[0].InForce().covariance);
  EXPECT_GE(edges[3].covariance(0, 0), 100.0);
  for (const int i : {1, 2, 4, 5}) EXPECT_EQ(edges[i].covariance, sound[i].covariance);
}

TEST_F(SeedPoseGraphTest, ClosuresGoByThePosesOfTheirKeyframes) {
  keys_.closures = {{0, 2, {0.1, 0.2, 0.3}, CorrelatedCovariance()}};
  keys_.contradicted = {{0, 1, {9.0, 0.0, 0.0}, CorrelatedCovariance()}};
  const std::vector<RelativePoseConstraint> edges = Graph();
  ASSERT_EQ(edges.size(), 10u);
  EXPECT_EQ(edges[9].from, 1);
  EXPECT_EQ(edges[9].to, 8);
  EXPECT_EQ(edges[9].from_from_to.yaw, 0.3);
  EXPECT_EQ(edges[9].covariance, CorrelatedCovariance());
}

TEST_F(SeedPoseGraphTest, NoStepLeadsFromOneSessionToTheNext) {
  keys_.sequential[0].broken = keys_.sequential[0].between_sessions = true;
  keys_.sequential[0].first_pose_after = 4;
  const std::vector<RelativePoseConstraint> edges = Graph();
  ASSERT_EQ(edges.size(), 8u);
  for (const RelativePoseConstraint& edge : edges) EXPECT_NE(edge.to, 4);
}

TEST_F(SeedPoseGraphTest, ASinglePoseHasNoEdges) {
  trajectory_.world_from_robot.resize(1);
  trajectory_.odometry.resize(1);
  keys_ = KeyframeGraph();
  EXPECT_TRUE(Graph().empty());
}

}  // namespace
}  // namespace plumbline
