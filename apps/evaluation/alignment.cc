#include "plumbline/apps/evaluation/alignment.h"

#include <cmath>
#include <cstddef>

namespace plumbline {
namespace {

Eigen::Vector2d MeanPosition(const std::vector<Pose2>& poses) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Pose2& pose : poses) sum += pose.translation();
  return sum / static_cast<double>(poses.size());
}

}  // namespace

Pose2 AlignTrajectories(const std::vector<Pose2>& world_from_robot,
                        const std::vector<Pose2>& truth_from_robot) {
  const Eigen::Vector2d from = MeanPosition(world_from_robot);
  const Eigen::Vector2d to = MeanPosition(truth_from_robot);
  double cosine = 0.0, sine = 0.0;
  for (std::size_t i = 0; i < world_from_robot.size(); ++i) {
    const Eigen::Vector2d a = world_from_robot[i].translation() - from;
    const Eigen::Vector2d b = truth_from_robot[i].translation() - to;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  // What rounding leaves of two trajectories without extent is below this sum [m^2].
  const bool moved = std::hypot(cosine, sine) > 1e-9;
  const double yaw = moved ? std::atan2(sine, cosine)
                           : truth_from_robot.front().yaw - world_from_robot.front().yaw;
  const Eigen::Vector2d shift = to - Pose2(0.0, 0.0, yaw) * from;
  return {shift.x(), shift.y(), yaw};
}

}  // namespace plumbline
