#include "plumbline/solvers/front_end/odometry_headings.h"

#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/front_end/odometry_noise.h"

namespace plumbline {
namespace {

// Of path to either side [m]: long enough for the noise of single matches to cancel, short enough
// to follow a matching that turns off in some places only.
constexpr double kMeanReachM = 20.0;

}  // namespace

SequentialTrajectory WithOdometryHeadings(const SequentialTrajectory& matched,
                                          const std::vector<Pose2>& given,
                                          const MotionOptions& motion) {
  const std::size_t num_poses = matched.world_from_robot.size();
  std::vector<Pose2> steps(num_poses);
  std::vector<double> path_m(num_poses, 0.0);
  std::vector<double> turned_rad(num_poses, 0.0);  // by the odometry more than by the matching
  for (std::size_t p = 1; p < num_poses; ++p) {
    steps[p] = Between(matched.world_from_robot[p - 1], matched.world_from_robot[p]);
    const Pose2 odometry = Between(given[p - 1], given[p]);
    const double turn_rad = NormalizeAngle(odometry.yaw - steps[p].yaw);
    path_m[p] = path_m[p - 1] + std::hypot(steps[p].x, steps[p].y);
    turned_rad[p] = turned_rad[p - 1] + (IsLeap(odometry, steps[p], motion) ? 0.0 : turn_rad);
  }
  SequentialTrajectory turned = matched;
  std::size_t first = 0, last = 0;  // of the poses within reach, and the one before
  for (std::size_t p = 1; p < num_poses; ++p) {
    while (first + 1 < p && path_m[p] - path_m[first] > kMeanReachM) ++first;
    while (last + 1 < num_poses && path_m[last + 1] - path_m[p] <= kMeanReachM) ++last;
    const double mean_rad =
        (turned_rad[last] - turned_rad[first]) / static_cast<double>(last - first);
    const Pose2 half(0.0, 0.0, 0.5 * mean_rad);
    turned.world_from_robot[p] = turned.world_from_robot[p - 1] * (half * steps[p] * half);
  }
  return turned;
}

}  // namespace plumbline
