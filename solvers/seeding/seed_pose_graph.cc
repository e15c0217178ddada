#include "plumbline/solvers/seeding/seed_pose_graph.h"

#include <Eigen/Core>

#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"

namespace plumbline {
namespace {

// A covariance of the end of a stretch, given in the frame of its beginning, as one of a step that
// alone causes it. begin_from_step: where the step begins; begin_from_end: the end of the stretch.
Eigen::Matrix3d CausedByStep(const Eigen::Matrix3d& at_end, const Pose2& begin_from_step,
                             const Pose2& step, const Pose2& begin_from_end) {
  // An error of the step's yaw swings the rest of the way, which the covariance does without.
  const Eigen::Vector2d arm = begin_from_end.translation() - (begin_from_step * step).translation();
  Eigen::Matrix3d unswing = Eigen::Matrix3d::Identity();
  unswing(0, 2) = arm.y();
  unswing(1, 2) = -arm.x();
  const Eigen::Matrix3d covariance =
      RotateAxes(unswing * at_end * unswing.transpose(), -begin_from_step.yaw);
  return 0.5 * (covariance + covariance.transpose());
}

// Shares the error of the edge from keyframe k to the next one out to the steps between them.
void ShareOut(const KeyframeGraph& keys, int k, const std::vector<Pose2>& world_from_robot,
              std::vector<RelativePoseConstraint>* steps) {
  const SequentialEdge& edge = keys.sequential[k];
  const int first = keys.keyframes[k].pose, last = keys.keyframes[k + 1].pose;
  const Pose2& begin = world_from_robot[first];
  for (int pose = first; pose < last; ++pose) {
    RelativePoseConstraint& step = (*steps)[pose];
    step.covariance = CausedByStep(edge.constraint.covariance / (last - first),
                                   Between(begin, world_from_robot[pose]), step.from_from_to,
                                   edge.constraint.from_from_to);
    if (edge.broken && step.to == edge.first_pose_after) {
      step.covariance = edge.InForce().covariance;
    }
  }
}

}  // namespace

std::vector<RelativePoseConstraint> SeedPoseGraph(const KeyframeGraph& keys,
                                                  const SequentialTrajectory& trajectory,
                                                  const MotionOptions& motion) {
  const std::vector<Pose2>& poses = trajectory.world_from_robot;
  std::vector<RelativePoseConstraint> edges;
  for (int to = 1; to < static_cast<int>(poses.size()); ++to) {
    edges.push_back({to - 1, to, Between(poses[to - 1], poses[to]),
                     MotionCovariance(trajectory.odometry[to], motion)});
  }
  for (int k = 0; k + 1 < keys.size(); ++k) ShareOut(keys, k, poses, &edges);
  for (int k = keys.size() - 2; k >= 0; --k) {
    const SequentialEdge& edge = keys.sequential[k];
    if (edge.between_sessions) edges.erase(edges.begin() + edge.first_pose_after - 1);
  }
  for (RelativePoseConstraint closure : keys.closures) {
    closure.from = keys.keyframes[closure.from].pose;
    closure.to = keys.keyframes[closure.to].pose;
    edges.push_back(closure);
  }
  return edges;
}

}  // namespace plumbline
