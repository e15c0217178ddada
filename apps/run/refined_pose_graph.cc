#include "plumbline/apps/run/refined_pose_graph.h"

#include <Eigen/Core>
#include <cmath>

#include "plumbline/apps/io/pose_graph_writer.h"

namespace plumbline {

RelativePoseConstraint MoveRobotFrame(const RelativePoseConstraint& edge, const Pose2& b_from_a) {
  const Pose2& motion = edge.from_from_to;
  RelativePoseConstraint moved = edge;
  moved.from_from_to = b_from_a.Inverse() * motion * b_from_a;
  // t = R_ba^T (t_edge + R_edge t_ba - t_ba) by (x, y, yaw) of the edge.
  const double ca = std::cos(b_from_a.yaw), sa = std::sin(b_from_a.yaw);
  const double ce = std::cos(motion.yaw), se = std::sin(motion.yaw);
  Eigen::Matrix2d a_from_b;
  a_from_b << ca, sa, -sa, ca;
  const Eigen::Vector2d by_yaw(-se * b_from_a.x - ce * b_from_a.y,
                               ce * b_from_a.x - se * b_from_a.y);
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian.topLeftCorner<2, 2>() = a_from_b;
  jacobian.topRightCorner<2, 1>() = a_from_b * by_yaw;
  const Eigen::Matrix3d covariance = jacobian * edge.covariance * jacobian.transpose();
  moved.covariance = 0.5 * (covariance + covariance.transpose());
  return moved;
}

Status WriteRefinedPoseGraph(const std::string& path, const std::vector<double>& poses,
                             const std::vector<RelativePoseConstraint>& edges,
                             const Pose2& before_from_after) {
  SlamGraph poses_and_edges;
  for (const Pose2& world_from_robot : PosesOf(poses)) {
    poses_and_edges.AddPose(world_from_robot, 0.0);
  }
  for (const RelativePoseConstraint& edge : edges) {
    poses_and_edges.AddRelativePose(MoveRobotFrame(edge, before_from_after));
  }
  PLUMBLINE_RETURN_IF_ERROR(poses_and_edges.status());
  return WritePoseGraph(path, poses_and_edges, MotionOptions(), {}, poses);
}

}  // namespace plumbline
