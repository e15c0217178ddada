#include "plumbline/solvers/front_end/odometry_headings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/front_end/odometry_noise.h"

namespace plumbline {
namespace {

// Path to either side [m]: up to there the matching, whose local map reaches as far, does not
// drift. On the hospital campus all loops are closed with 7 to 20 m, and not with 5 or 40.
constexpr double kMeanReachM = 12.0;

// The mean of a value over the path around a place. Path and value are given per pose and linear in
// between. Beyond its ends the path is reflected, so that the mean of both ends is their value.
class MeanOverPath {
 public:
  MeanOverPath(const std::vector<double>& path_m, const std::vector<double>& value, double reach_m)
      : path_m_(path_m), value_(value), reach_m_(std::min(reach_m, path_m.back())) {
    integral_.push_back(0.0);
    for (std::size_t p = 1; p < value.size(); ++p) {
      integral_.push_back(integral_.back() +
                          0.5 * (value[p - 1] + value[p]) * (path_m[p] - path_m[p - 1]));
    }
  }

  double At(std::size_t p) const {
    if (reach_m_ == 0.0) return value_[p];
    return (Integral(path_m_[p] + reach_m_) - Integral(path_m_[p] - reach_m_)) / (2.0 * reach_m_);
  }

 private:
  // From the start of the path.
  double Integral(double to_m) const {
    const double end_m = path_m_.back();
    if (to_m < 0.0) return 2.0 * value_.front() * to_m + Integral(-to_m);
    if (to_m > end_m) {
      return 2.0 * value_.back() * (to_m - end_m) + Integral(2.0 * end_m - to_m);
    }
    const auto next = std::upper_bound(path_m_.begin(), path_m_.end(), to_m);
    const std::size_t p = next - path_m_.begin() - 1;
    if (next == path_m_.end()) return integral_[p];
    const double along_m = to_m - path_m_[p];
    const double rise = (value_[p + 1] - value_[p]) / (path_m_[p + 1] - path_m_[p]);
    return integral_[p] + along_m * (value_[p] + 0.5 * rise * along_m);
  }

  const std::vector<double>&path_m_, &value_;
  const double reach_m_;
  std::vector<double> integral_;  // of the value, from the start to each pose
};

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
  if (num_poses == 0) return turned;
  const MeanOverPath mean(path_m, turned_rad, kMeanReachM);
  for (std::size_t p = 1; p < num_poses; ++p) {
    const Pose2 half(0.0, 0.0, 0.5 * (mean.At(p) - mean.At(p - 1)));
    turned.world_from_robot[p] = turned.world_from_robot[p - 1] * (half * steps[p] * half);
  }
  return turned;
}

}  // namespace plumbline
