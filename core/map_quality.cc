#include "plumbline/core/map_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// Variance [m^2] that a perfectly thin neighbourhood counts with: (0.1 mm)^2.
constexpr double kSmallestVariance = 1e-8;

// Points sorted by square cells. A cell that lies within a neighbourhood gives its moments as a
// whole; points are looked at one by one only where the edge of the neighbourhood passes.
class CellSortedPoints {
 public:
  CellSortedPoints(const std::vector<double>& points, double radius_m)
      : radius_m_(radius_m), cell_m_(radius_m / kCellsPerRadius) {
    const std::size_t num_points = points.size() / 2;
    std::vector<int> cell_of_point(num_points);
    for (std::size_t i = 0; i < num_points; ++i) {
      const std::uint64_t key = Key(Index(points[2 * i]), Index(points[2 * i + 1]));
      // Neighbouring beams mostly end in the same cell.
      if (i == 0 || key != cells_[cell_of_point[i - 1]].key) {
        const auto [entry, is_new] = cell_of_key_.try_emplace(key, static_cast<int>(cells_.size()));
        if (is_new) {
          cells_.emplace_back();
          cells_.back().key = key;
        }
        cell_of_point[i] = entry->second;
      } else {
        cell_of_point[i] = cell_of_point[i - 1];
      }
      ++cells_[cell_of_point[i]].num_points;
    }
    std::size_t first = 0;
    for (Cell& cell : cells_) {
      cell.first = first;
      first += std::exchange(cell.num_points, 0);
    }
    points_.resize(num_points);
    for (std::size_t i = 0; i < num_points; ++i) {
      Cell& cell = cells_[cell_of_point[i]];
      const Eigen::Vector2d point(points[2 * i], points[2 * i + 1]);
      if (cell.num_points == 0) {
        cell.center = {(Index(point.x()) + 0.5) * cell_m_, (Index(point.y()) + 0.5) * cell_m_};
      }
      const Eigen::Vector2d offset = point - cell.center;
      cell.moments.Add(offset.x(), offset.y());
      points_[cell.first + cell.num_points++] = point;
    }
  }

  // Moments about `center` of all points within the radius of it.
  PointMoments MomentsAround(const Eigen::Vector2d& center) const {
    PointMoments moments;
    const double cx = Index(center.x()), cy = Index(center.y());
    for (int dx = -kCellsPerRadius; dx <= kCellsPerRadius; ++dx) {
      for (int dy = -kCellsPerRadius; dy <= kCellsPerRadius; ++dy) {
        const auto entry = cell_of_key_.find(Key(cx + dx, cy + dy));
        if (entry != cell_of_key_.end()) AddCell(cells_[entry->second], center, &moments);
      }
    }
    return moments;
  }

 private:
  static constexpr int kCellsPerRadius = 3;

  struct Cell {
    std::uint64_t key = 0;
    std::size_t first = 0;
    std::size_t num_points = 0;
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    PointMoments moments;  // about the centre
  };

  void AddCell(const Cell& cell, const Eigen::Vector2d& center, PointMoments* moments) const {
    const Eigen::Vector2d offset = cell.center - center;
    const double half = 0.5 * cell_m_;
    if ((offset.cwiseAbs().array() + half).matrix().norm() < (1.0 - 1e-9) * radius_m_) {
      *moments += cell.moments.Shifted(offset.x(), offset.y());
      return;
    }
    for (std::size_t i = cell.first; i < cell.first + cell.num_points; ++i) {
      const Eigen::Vector2d to_point = points_[i] - center;
      if (to_point.squaredNorm() <= radius_m_ * radius_m_) moments->Add(to_point.x(), to_point.y());
    }
  }

  double Index(double coordinate_m) const { return std::floor(coordinate_m / cell_m_); }
  // 31 bits each hold any map on Earth.
  static std::uint64_t Key(double column, double row) {
    constexpr std::int64_t kOffset = std::int64_t{1} << 30;
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(row) + kOffset) << 32 |
           static_cast<std::uint64_t>(static_cast<std::int64_t>(column) + kOffset);
  }

  double radius_m_;
  double cell_m_;
  std::unordered_map<std::uint64_t, int> cell_of_key_;
  std::vector<Cell> cells_;
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
