#include "plumbline/apps/benchmark/map_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"

namespace plumbline {

MapErrors MeasureMapErrors(const MapEstimate& estimate, const MapEstimate& truth) {
  MapErrors errors;
  const Pose2 truth_from_estimate = truth.poses.front() * estimate.poses.front().Inverse();
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const Pose2 pose = truth_from_estimate * estimate.poses[i];
    errors.pose_m.push_back((pose.translation() - truth.poses[i].translation()).norm());
    errors.heading_rad.push_back(std::abs(NormalizeAngle(pose.yaw - truth.poses[i].yaw)));
  }
  for (std::size_t i = 0; i < truth.points.size(); i += 2) {
    const Eigen::Vector2d point(estimate.points[i], estimate.points[i + 1]);
    const Eigen::Vector2d exact(truth.points[i], truth.points[i + 1]);
    errors.point_m.push_back((truth_from_estimate * point - exact).norm());
  }
  return errors;
}

MeanAndVariance MeanAndVarianceOf(const std::vector<double>& values) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    count += 1.0;
    sum += value;
  }
  const double mean = sum / count;  // 0 / 0 is NaN, as documented
  for (const double value : values) {
    if (!std::isnan(value)) squares += (value - mean) * (value - mean);
  }
  return {mean, squares / count};
}

Quartiles QuartilesOf(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return Quartiles();
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    const double rest = place - static_cast<double>(below);
    return (1.0 - rest) * values[below] + rest * values[above];
  };
  return {at(0.25), at(0.5), at(0.75)};
}

}  // namespace plumbline
