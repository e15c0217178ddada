#include "plumbline/apps/run/refined_pose_graph.h"

#include <gtest/gtest.h>

#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/factors/factor_testing.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

void ExpectNear(const Pose2& a, const Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(NormalizeAngle(a.yaw - b.yaw), 0.0, tolerance);
}

RelativePoseConstraint Edge() { return {0, 1, {1.5, -0.5, 2.2}, CorrelatedCovariance()}; }

TEST(RefinedPoseGraphTest, TheSameFrameLeavesEdgesAlone) {
  const RelativePoseConstraint edge = Edge(), same = MoveRobotFrame(edge, Pose2());
  EXPECT_EQ(same.from_from_to.x, edge.from_from_to.x);
  EXPECT_EQ(same.from_from_to.y, edge.from_from_to.y);
  EXPECT_EQ(same.from_from_to.yaw, edge.from_from_to.yaw);
  EXPECT_TRUE(same.covariance.isApprox(edge.covariance, 1e-15));
}

TEST(RefinedPoseGraphTest, EdgesMoveWithTheFrameOfTheRobot) {
  const Pose2 b_from_a(0.3, -0.2, 0.7), world_from_b0(4.0, 5.0, -1.0);
  const RelativePoseConstraint edge = Edge(), moved = MoveRobotFrame(edge, b_from_a);
  const Pose2 world_from_b1 = world_from_b0 * edge.from_from_to;
  ExpectNear(Between(world_from_b0 * b_from_a, world_from_b1 * b_from_a), moved.from_from_to,
             1e-12);
  // The covariance, column by column of a square root of it.
  const double step = 1e-6;
  Eigen::Matrix3d root = edge.covariance.llt().matrixL();
  for (int k = 0; k < 3; ++k) {
    RelativePoseConstraint ahead = edge, behind = edge;
    const auto shift = [&](double scale, Pose2* pose) {
      pose->x += scale * root(0, k);
      pose->y += scale * root(1, k);
      pose->yaw += scale * root(2, k);
    };
    shift(step, &ahead.from_from_to);
    shift(-step, &behind.from_from_to);
    const Pose2 a = MoveRobotFrame(ahead, b_from_a).from_from_to;
    const Pose2 b = MoveRobotFrame(behind, b_from_a).from_from_to;
    root.col(k) = Eigen::Vector3d(a.x - b.x, a.y - b.y, a.yaw - b.yaw) / (2.0 * step);
  }
  EXPECT_TRUE(moved.covariance.isApprox(root * root.transpose(), 1e-6));
}

TEST(RefinedPoseGraphTest, WritesPosesAndEdgesWithoutScans) {
  const std::vector<double> poses = MakeNoisyRoom().state.poses;
  const int num_poses = static_cast<int>(poses.size() / 3);
  std::vector<RelativePoseConstraint> edges;
  for (int i = 0; i < num_poses; ++i) {
    edges.push_back({i, (i + 1) % num_poses, {0.1 * i, 0.2, 0.3}, CorrelatedCovariance()});
  }
  const std::string folder = TempFolder();
  ASSERT_TRUE(WriteRefinedPoseGraph(folder + "a.g2o", poses, edges, Pose2()).ok());
  PoseGraphFile file;
  const Status status = ReadPoseGraphFile(folder + "a.g2o", &file);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(file.graph.initial_poses(), poses);
  EXPECT_EQ(file.graph.num_scans(), 0);
  ASSERT_EQ(file.graph.relative_poses().size(), edges.size());
  EXPECT_EQ(file.graph.relative_poses()[4].from_from_to.x, edges[4].from_from_to.x);
  EXPECT_TRUE(file.graph.relative_poses()[4].covariance.isApprox(edges[4].covariance, 1e-12));
  EXPECT_EQ(WriteRefinedPoseGraph(folder + "none/a.g2o", poses, edges, Pose2()).code(),
            StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
