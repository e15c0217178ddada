#include "plumbline/core/map_quality.h"

#include <algorithm>
#include <cmath>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/point_index.h"

namespace plumbline {
namespace {

// Variance [m^2] that a perfectly thin neighbourhood counts with: (0.1 mm)^2.
constexpr double kSmallestVariance = 1e-8;

struct Sample {
  double thickness_m = -1.0;  // negative: too few neighbours
  double entropy = 0.0;
};

Sample MeasureAt(const PointIndex& index, const std::vector<double>& points, std::size_t i,
                 const MapQualityOptions& options, std::vector<PointIndex::Neighbor>* neighbors) {
  Sample sample;
  const Eigen::Vector2d center(points[2 * i], points[2 * i + 1]);
  index.FindWithin(center, options.radius_m, neighbors);
  if (neighbors->size() < options.min_points) return sample;
  PointMoments moments;
  for (const PointIndex::Neighbor& neighbor : *neighbors) {
    moments.Add(points[2 * neighbor.point] - center.x(),
                points[2 * neighbor.point + 1] - center.y());
  }
  const LineFit fit = FitLine(moments);
  sample.thickness_m = std::sqrt(fit.smaller_eigenvalue);
  const double determinant = std::max(fit.smaller_eigenvalue, kSmallestVariance) *
                             std::max(fit.larger_eigenvalue, kSmallestVariance);
  sample.entropy = 0.5 * std::log(determinant) + std::log(2.0 * kPi * std::exp(1.0));
  return sample;
}

}  // namespace

bool MapQualityOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(radius_m, >, 0.0);
  PLUMBLINE_CHECK_OPTION(min_points, >=, std::size_t{3});
  PLUMBLINE_CHECK_OPTION(max_samples, >, std::size_t{0});
  return true;
}

MapQuality MeasureMapQuality(const std::vector<double>& points, const MapQualityOptions& options,
                             ThreadPool* pool) {
  const std::size_t num_points = points.size() / 2;
  const std::size_t num_samples = std::min(num_points, options.max_samples);
  const PointIndex index(points);
  std::vector<Sample> samples(num_samples);
  constexpr std::size_t kSamplesPerChunk = 256;
  pool->ForEachChunk(num_samples, kSamplesPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       std::vector<PointIndex::Neighbor> neighbors;
                       for (std::size_t k = begin; k < end; ++k) {
                         const std::size_t i = k * num_points / num_samples;
                         samples[k] = MeasureAt(index, points, i, options, &neighbors);
                       }
                     });
  MapQuality quality;
  std::vector<double> thicknesses;
  for (const Sample& sample : samples) {
    if (sample.thickness_m < 0.0) continue;
    thicknesses.push_back(sample.thickness_m);
    quality.mean_map_entropy += sample.entropy;
  }
  quality.num_samples = thicknesses.size();
  if (thicknesses.empty()) return quality;
  quality.mean_map_entropy /= static_cast<double>(thicknesses.size());
  const auto middle = thicknesses.begin() + thicknesses.size() / 2;
  std::nth_element(thicknesses.begin(), middle, thicknesses.end());
  quality.wall_thickness_m = *middle;
  return quality;
}

}  // namespace plumbline
