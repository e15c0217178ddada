#include "plumbline/core/map_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

// Neighbourhoods of fewer points are left out.
constexpr double kMinPoints = 10.0;
// Points to measure at, at most, taken evenly from all.
constexpr std::size_t kMaxSamples = 20000;
// Variance [m^2] that a perfectly thin neighbourhood counts with: (0.1 mm)^2.
constexpr double kSmallestVariance = 1e-8;

// Points sorted by square cells. A cell that lies within a neighbourhood gives its moments as a
// whole; points are looked at one by one only where the edge of the neighbourhood passes.
class CellSortedPoints {
 public:
  CellSortedPoints(const MapPoints& points, double radius_m)
      : radius_m_(radius_m),
        cell_m_(radius_m / kCellsPerRadius),
        cells_per_m_(kCellsPerRadius / radius_m),
        offset_step_m_(cell_m_ / kOffsetSteps),
        steps_per_m_(kOffsetSteps / cell_m_) {
    const std::vector<int> cell_of_point = FindCells(points);
    const std::vector<int> place_of_cell = SortCells();
    offsets_.resize(cell_of_point.size());
    int found = -1;
    Cell* cell = nullptr;
    Eigen::Vector2d center = Eigen::Vector2d::Zero();
    PointMoments moments;  // of the cell, while one point after the other lies in it
    Offset* offset = nullptr;
    points.ForEach([&](std::size_t i, double world_x, double world_y) {
      if (cell_of_point[i] != found) {
        if (cell != nullptr) cell->moments = moments;
        found = cell_of_point[i];
        cell = &cells_[place_of_cell[found]];
        center = Center(cell->key);
        moments = cell->moments;
        offset = &offsets_[cell->first + static_cast<std::size_t>(moments.weight)];
      }
      const double x = world_x - center.x(), y = world_y - center.y();
      moments.Add(x, y);
      *offset++ = {Steps(x), Steps(y)};
    });
    if (cell != nullptr) cell->moments = moments;
  }

  // Moments about `center` of all points within the radius of it.
  PointMoments MomentsAround(const Eigen::Vector2d& center) const {
    PointMoments moments;
    const std::int64_t column = Index(center.x()), row = Index(center.y());
    for (std::int64_t y = row - kCellsPerRadius; y <= row + kCellsPerRadius; ++y) {
      const auto first =
          std::lower_bound(cells_.begin(), cells_.end(), Key(column - kCellsPerRadius, y),
                           [](const Cell& cell, std::uint64_t key) { return cell.key < key; });
      const std::uint64_t last_key = Key(column + kCellsPerRadius, y);
      for (auto cell = first; cell != cells_.end() && cell->key <= last_key; ++cell) {
        AddCell(*cell, center, &moments);
      }
    }
    return moments;
  }

 private:
  static constexpr int kCellsPerRadius = 6;
  static constexpr std::int64_t kIndexOffset = std::int64_t{1} << 30;
  static constexpr double kOffsetSteps = 65000.0;  // across a cell

  struct Cell {
    std::uint64_t key = 0;
    std::size_t first = 0;
    PointMoments moments;  // about the centre; their weight is the number of points
  };
  struct FoundCell {
    std::uint64_t key = 0;
    std::size_t num_points = 0;
  };
  struct Offset {
    std::int16_t x, y;
  };

  // Finds the cells, in order of their first points, and counts their points.
  std::vector<int> FindCells(const MapPoints& points) {
    std::unordered_map<std::uint64_t, int> cell_of_key;
    // One scan after the other hits the same walls: the last cell seen per place in a square spares
    // most look-ups.
    constexpr std::int64_t kSquareCells = 128;
    std::vector<int> last_seen(kSquareCells * kSquareCells, -1);
    std::vector<int> cell_of_point(points.size());
    points.ForEach([&](std::size_t i, double x, double y) {
      const std::int64_t column = Index(x), row = Index(y);
      const std::uint64_t key = Key(column, row);
      int& cell =
          last_seen[(row & (kSquareCells - 1)) * kSquareCells + (column & (kSquareCells - 1))];
      if (cell < 0 || key != found_[cell].key) {
        const auto [entry, is_new] = cell_of_key.try_emplace(key, static_cast<int>(found_.size()));
        if (is_new) found_.push_back({key, 0});
        cell = entry->second;
      }
      cell_of_point[i] = cell;
      ++found_[cell].num_points;
    });
    return cell_of_point;
  }

  // Makes the cells, row by row, with room for their points. Gives the place of each that was
  // found.
  std::vector<int> SortCells() {
    std::vector<int> cell_at(found_.size()), place_of_cell(found_.size());
    std::iota(cell_at.begin(), cell_at.end(), 0);
    std::sort(cell_at.begin(), cell_at.end(),
              [this](int a, int b) { return found_[a].key < found_[b].key; });
    cells_.reserve(found_.size());
    std::size_t first = 0;
    for (const int found : cell_at) {
      place_of_cell[found] = static_cast<int>(cells_.size());
      cells_.push_back({found_[found].key, first, PointMoments()});
      first += found_[found].num_points;
    }
    found_ = std::vector<FoundCell>();
    return place_of_cell;
  }

  void AddCell(const Cell& cell, const Eigen::Vector2d& center, PointMoments* moments) const {
    constexpr double kRounding = 1e-9;
    const Eigen::Vector2d offset = Center(cell.key) - center;
    const Eigen::Array2d distance = offset.cwiseAbs();
    const double half = 0.5 * cell_m_, radius_squared = radius_m_ * radius_m_;
    if ((distance + half).matrix().squaredNorm() < (1.0 - kRounding) * radius_squared) {
      *moments += cell.moments.Shifted(offset.x(), offset.y());
      return;
    }
    const Eigen::Vector2d nearest = (distance - half).max(0.0);
    if (nearest.squaredNorm() > (1.0 + kRounding) * radius_squared) return;
    const std::size_t end = cell.first + static_cast<std::size_t>(cell.moments.weight);
    for (std::size_t i = cell.first; i < end; ++i) {
      const Eigen::Vector2d to_point =
          offset + offset_step_m_ * Eigen::Vector2d(offsets_[i].x, offsets_[i].y);
      // No branch: nobody could foresee it.
      const double inside = to_point.squaredNorm() <= radius_squared ? 1.0 : 0.0;
      moments->Add(to_point.x(), to_point.y(), inside);
    }
  }

  // The nearest number; std::lround is a call per point.
  std::int16_t Steps(double offset_m) const {
    const double steps = offset_m * steps_per_m_;
    // NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return static_cast<std::int16_t>(static_cast<int>(steps + std::copysign(0.5, steps)));
  }

  // std::floor is a call into the C library unless the build is for newer processors only.
  std::int64_t Index(double coordinate_m) const {
    const double cells = coordinate_m * cells_per_m_;
    const auto truncated = static_cast<std::int64_t>(cells);
    return truncated - (static_cast<double>(truncated) > cells ? 1 : 0);
  }
  // 31 bits each hold any map on Earth. In order of rows, and in a row of columns.
  static std::uint64_t Key(std::int64_t column, std::int64_t row) {
    return static_cast<std::uint64_t>(row + kIndexOffset) << 32 |
           static_cast<std::uint64_t>(column + kIndexOffset);
  }
  Eigen::Vector2d Center(std::uint64_t key) const {
    const auto center = [this](std::uint64_t index) {
      return (static_cast<double>(static_cast<std::int64_t>(index) - kIndexOffset) + 0.5) * cell_m_;
    };
    return {center(key & 0xffffffff), center(key >> 32)};
  }

  double radius_m_;
  double cell_m_, cells_per_m_;
  double offset_step_m_, steps_per_m_;
  std::vector<FoundCell> found_;  // until they are sorted
  std::vector<Cell> cells_;       // in order of keys
  std::vector<Offset> offsets_;   // of points from the centres of their cells: to a micrometre
};

struct Sample {
  double thickness_m = -1.0;  // negative: too few neighbours
  double entropy = 0.0;
};

Sample MeasureAt(const PointMoments& moments) {
  Sample sample;
  if (moments.weight < kMinPoints) return sample;
  const LineFit fit = FitLine(moments);
  sample.thickness_m = std::sqrt(fit.smaller_eigenvalue);
  const double determinant = std::max(fit.smaller_eigenvalue, kSmallestVariance) *
                             std::max(fit.larger_eigenvalue, kSmallestVariance);
  sample.entropy = 0.5 * std::log(determinant) + std::log(2.0 * kPi * std::exp(1.0));
  return sample;
}

template <typename Body>
void ForEachSample(std::size_t num_samples, ThreadPool* pool, const Body& body) {
  constexpr std::size_t kSamplesPerChunk = 256;
  pool->ForEachChunk(num_samples, kSamplesPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t k = begin; k < end; ++k) body(k);
                     });
}

MapQuality QualityOf(const std::vector<Sample>& samples) {
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

// Where to measure the points of a graph and its peers: at the same ones as without peers, each of
// which one process has.
std::vector<double> CentersAmongAll(const SlamGraph& graph, const MapPoints& points) {
  const std::size_t num_points = graph.num_returns_of_all();
  const std::size_t num_samples = std::min(num_points, kMaxSamples);
  std::vector<double> centers(2 * num_samples);
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& own = graph.scan(s);
    const ScanEntry& among_all = graph.all_scans()[graph.IdAmongAll(s)];
    const std::size_t end = among_all.first_return + among_all.num_returns;
    // The first sample that does not lie before this scan.
    std::size_t k = (among_all.first_return * num_samples + num_points - 1) / num_points;
    for (; k < num_samples && k * num_points / num_samples < end; ++k) {
      const std::size_t in_scan = k * num_points / num_samples - among_all.first_return;
      const Eigen::Vector2d center = points.At(own.first_return + in_scan);
      centers[2 * k] = center.x();
      centers[2 * k + 1] = center.y();
    }
  }
  SumOverPeers(graph.peers(), &centers);
  return centers;
}

}  // namespace

bool MapQualityOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(radius_m, >, 0.0);
  return true;
}

MapQuality MeasureMapQuality(const MapPoints& points, const MapQualityOptions& options,
                             ThreadPool* pool) {
  const std::size_t num_points = points.size();
  const std::size_t num_samples = std::min(num_points, kMaxSamples);
  const CellSortedPoints sorted(points, options.radius_m);
  std::vector<Sample> samples(num_samples);
  ForEachSample(num_samples, pool, [&](std::size_t k) {
    const std::size_t i = k * num_points / num_samples;
    samples[k] = MeasureAt(sorted.MomentsAround(points.At(i)));
  });
  return QualityOf(samples);
}

MapQuality MeasureMapQuality(const SlamGraph& graph, const MapPoints& points,
                             const MapQualityOptions& options, ThreadPool* pool) {
  const Peers* peers = graph.peers();
  if (peers == nullptr) return MeasureMapQuality(points, options, pool);
  const std::vector<double> centers = CentersAmongAll(graph, points);
  const CellSortedPoints sorted(points, options.radius_m);
  std::vector<Sample> samples(centers.size() / 2);
  constexpr std::size_t kMoments = 6;
  std::vector<double> sums(kMoments * samples.size());
  ForEachSample(samples.size(), pool, [&](std::size_t k) {
    const PointMoments own =
        sorted.MomentsAround(Eigen::Vector2d(centers[2 * k], centers[2 * k + 1]));
    const double moments[kMoments] = {own.weight, own.x, own.y, own.xx, own.xy, own.yy};
    std::copy_n(moments, kMoments, &sums[kMoments * k]);
  });
  SumOverPeers(peers, &sums);
  ForEachSample(samples.size(), pool, [&](std::size_t k) {
    const double* sum = &sums[kMoments * k];
    samples[k] = MeasureAt({sum[0], sum[1], sum[2], sum[3], sum[4], sum[5]});
  });
  return QualityOf(samples);
}

}  // namespace plumbline
