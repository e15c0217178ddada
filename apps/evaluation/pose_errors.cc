#include "plumbline/apps/evaluation/pose_errors.h"

#include <algorithm>
#include <cmath>

#include "plumbline/apps/evaluation/alignment.h"
#include "plumbline/core/angle.h"

namespace plumbline {

ErrorStatistics Summarise(std::vector<double> errors, StatisticsConvention convention) {
  ErrorStatistics result;
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  const std::size_t size = errors.size();
  const double n = static_cast<double>(size);
  double sum = 0.0, sum_of_squares = 0.0, squared_deviations = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  result.mean = sum / n;
  for (const double error : errors) squared_deviations += std::pow(error - result.mean, 2);
  const bool evo = convention == StatisticsConvention::kEvo;
  result.std = std::sqrt(squared_deviations / (evo ? n : std::max(n - 1.0, 1.0)));
  result.rmse = std::sqrt(sum_of_squares / n);
  result.median = errors[size / 2];
  if (evo) result.median = 0.5 * (errors[(size - 1) / 2] + errors[size / 2]);
  result.p95 = errors[static_cast<std::size_t>(0.95 * (n - 1.0))];
  result.max = errors.back();
  return result;
}

void PoseErrors::Add(const Pose2& expected, const Pose2& actual) {
  translations_m_.push_back((actual.translation() - expected.translation()).norm());
  rotations_deg_.push_back(RadToDeg(std::abs(NormalizeAngle(actual.yaw - expected.yaw))));
}

void PoseErrors::AddFitted(const std::vector<Pose2>& truth, const std::vector<Pose2>& estimate) {
  if (truth.empty()) return;
  const Pose2 truth_from_world = AlignTrajectories(estimate, truth);
  for (std::size_t i = 0; i < truth.size(); ++i) Add(truth[i], truth_from_world * estimate[i]);
}

PoseErrorStatistics PoseErrors::Statistics() const {
  return {translations_m_.size(), num_unmatched_, Summarise(translations_m_, convention_),
          Summarise(rotations_deg_, convention_)};
}

}  // namespace plumbline
