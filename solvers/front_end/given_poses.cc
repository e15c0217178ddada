#include "plumbline/solvers/front_end/given_poses.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"

namespace plumbline {
namespace {

// Over this many steps errors of odometry add up to four times that of a single one, in variance
// sixteen times; independent errors stay as they are.
constexpr int kManySteps = 16;
// Largest ratio of the two for independent errors: half way, on a scale of ratios.
constexpr double kMaxGrowth = 2.0;
// Given poses that are laid on the matched ones together. Their mean is known to a third of the
// noise of one.
constexpr int kPosesAligned = 10;

// Medians of the disagreement over some steps: distance [m] and turn [rad].
PoseNoise MedianDisagreement(const std::vector<Pose2>& given, const std::vector<Pose2>& matched,
                             std::size_t num_steps) {
  std::vector<double> distance_m, turn_rad;
  for (std::size_t to = num_steps; to < given.size(); ++to) {
    const Pose2 off = Between(Between(matched[to - num_steps], matched[to]),
                              Between(given[to - num_steps], given[to]));
    distance_m.push_back(std::hypot(off.x, off.y));
    turn_rad.push_back(std::abs(NormalizeAngle(off.yaw)));
  }
  return {Median(std::move(distance_m)), Median(std::move(turn_rad))};
}

}  // namespace

std::optional<PoseNoise> MeasurePoseNoise(const std::vector<Pose2>& given,
                                          const std::vector<Pose2>& matched) {
  if (given.size() < 2 * kManySteps) return std::nullopt;
  const PoseNoise over_one = MedianDisagreement(given, matched, 1);
  const PoseNoise over_many = MedianDisagreement(given, matched, kManySteps);
  if (over_many.position_m > kMaxGrowth * over_one.position_m) return std::nullopt;
  // Median of the length of a vector of two normal errors, and of the size of one, in standard
  // deviations. A disagreement has the errors of two poses.
  constexpr double kMedianOfLength = 1.1774, kMedianOfSize = 0.6745;
  return PoseNoise{over_one.position_m / (std::sqrt(2.0) * kMedianOfLength),
                   over_one.yaw_rad / (std::sqrt(2.0) * kMedianOfSize)};
}

Pose2 StepToGivenPose(const std::vector<Pose2>& given, const std::vector<Pose2>& matched, int to) {
  Eigen::Vector2d mean_given = Eigen::Vector2d::Zero(), mean_matched = Eigen::Vector2d::Zero();
  Eigen::Vector2d turn = Eigen::Vector2d::Zero();
  const int from = std::max(0, to - kPosesAligned);
  for (int pose = from; pose < to; ++pose) {
    mean_given += given[pose].translation() / (to - from);
    mean_matched += matched[pose].translation() / (to - from);
    const double yaw = matched[pose].yaw - given[pose].yaw;
    turn += Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
  }
  const Pose2 rotation(0.0, 0.0, std::atan2(turn.y(), turn.x()));
  const Eigen::Vector2d position =
      mean_matched + rotation * Eigen::Vector2d(given[to].translation() - mean_given);
  return Between(matched[to - 1],
                 Pose2(position.x(), position.y(), NormalizeAngle(given[to].yaw + rotation.yaw)));
}

MotionOptions StepNoise(const PoseNoise& noise) {
  // The pose has its own error and that of the mean which was aligned.
  const double share = std::sqrt(1.0 + 1.0 / kPosesAligned);
  MotionOptions motion{0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  motion.translation_floor_m = share * noise.position_m;
  motion.rotation_floor_rad = share * noise.yaw_rad;
  return motion;
}

}  // namespace plumbline
