#include "plumbline/core/map_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// Variance [m^2] that a perfectly thin neighbourhood counts with: (0.1 mm)^2.
constexpr double kSmallestVariance = 1e-8;

// Points sorted by square cells of the neighbourhood's radius, row by row: a neighbourhood lies in
// three runs of three cells each.
class CellSortedPoints {
 public:
  CellSortedPoints(const std::vector<double>& points, double cell_m) : cell_m_(cell_m) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(points.size() / 2);
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = {Key(Cell(points[2 * i]), Cell(points[2 * i + 1])), static_cast<std::uint32_t>(i)};
    }
    std::sort(order.begin(), order.end());
    for (const auto& [key, i] : order) {
      keys_.push_back(key);
      points_.emplace_back(points[2 * i], points[2 * i + 1]);
    }
  }

  // Moments about `center` of all points within the cell size of it.
  PointMoments MomentsAround(const Eigen::Vector2d& center) const {
    PointMoments moments;
    const double radius_squared = cell_m_ * cell_m_;
    const std::int64_t cx = Cell(center.x()), cy = Cell(center.y());
    for (std::int64_t row = cy - 1; row <= cy + 1; ++row) {
      const auto begin = std::lower_bound(keys_.begin(), keys_.end(), Key(cx - 1, row));
      const auto end = std::upper_bound(begin, keys_.end(), Key(cx + 1, row));
      for (auto k = begin - keys_.begin(); k < end - keys_.begin(); ++k) {
        const Eigen::Vector2d offset = points_[k] - center;
        if (offset.squaredNorm() <= radius_squared) moments.Add(offset.x(), offset.y());
      }
    }
    return moments;
  }

 private:
  std::int64_t Cell(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m_));
  }
  // Orders cells by row, then by column; 31 bits each hold any map on Earth.
  static std::uint64_t Key(std::int64_t column, std::int64_t row) {
    constexpr std::int64_t kOffset = std::int64_t{1} << 30;
    return static_cast<std::uint64_t>(row + kOffset) << 32 |
           static_cast<std::uint64_t>(column + kOffset);
  }

  double cell_m_;
  std::vector<std::uint64_t> keys_;
  std::vector<Eigen::Vector2d> points_;
};

struct Sample {
  double thickness_m = -1.0;  // negative: too few neighbours
  double entropy = 0.0;
};

Sample MeasureAt(const PointMoments& moments, const MapQualityOptions& options) {
  Sample sample;
  if (moments.weight < static_cast<double>(options.min_points)) return sample;
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
  const CellSortedPoints sorted(points, options.radius_m);
  std::vector<Sample> samples(num_samples);
  constexpr std::size_t kSamplesPerChunk = 256;
  pool->ForEachChunk(num_samples, kSamplesPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t k = begin; k < end; ++k) {
                         const std::size_t i = k * num_points / num_samples;
                         const Eigen::Vector2d center(points[2 * i], points[2 * i + 1]);
                         samples[k] = MeasureAt(sorted.MomentsAround(center), options);
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
