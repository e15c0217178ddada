#include "plumbline/solvers/front_end/correct_odometry.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <utility>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/odometry_span.h"

namespace plumbline {

void CorrectOdometry(std::vector<Pose2> corrected, const MotionOptions& motion,
                     SequentialTrajectory* trajectory) {
  const std::vector<Pose2>& poses = trajectory->world_from_robot;
  KeyframeGraph keys;
  keys.keyframes = trajectory->keyframes;
  keys.sequential.resize(std::max(1, keys.size()) - 1);
  for (const Keyframe& key : keys.keyframes) keys.world_from_key.push_back(poses[key.pose]);
  for (int k = 1; k < keys.size(); ++k) {
    const Keyframe& from = keys.keyframes[k - 1];
    const Keyframe& to = keys.keyframes[k];
    const Pose2 matched = Between(poses[from.pose], poses[to.pose]);
    const OdometrySpan before = ChainOdometry(trajectory->odometry, from.pose, to.pose, motion);
    const OdometrySpan after = ChainOdometry(corrected, from.pose, to.pose, motion);
    const Eigen::Vector3d change(after.from_from_to.x - before.from_from_to.x,
                                 after.from_from_to.y - before.from_from_to.y,
                                 NormalizeAngle(after.from_from_to.yaw - before.from_from_to.yaw));
    // The share of the change that a match of this information lets through. Applied twice: a
    // little of each edge's change is the map's drag on the match, which does not add up over the
    // edges, while along a corridor the share is 1 and stays so.
    const Eigen::Matrix3d prior = before.covariance.inverse();
    const Eigen::Matrix3d match = RotateAxes(to.information, matched.yaw);
    const Eigen::Matrix3d share = (match + prior).inverse() * prior;
    const Eigen::Vector3d moved = share * share * change;
    keys.world_from_key[k] =
        keys.world_from_key[k - 1] *
        Pose2(matched.x + moved.x(), matched.y + moved.y(), matched.yaw + moved.z());
  }
  trajectory->world_from_robot = PosesFollowingKeyframes(keys, poses);
  trajectory->odometry = std::move(corrected);
}

}  // namespace plumbline
