// Tangent lines from the nearest neighbours of each point, their number in proportion to the
// density of the map.
//
// Points of a map lie along surfaces, so their density f is counted per metre of surface. It is
// estimated by the distance r to the k-th nearest point, f ~ k / (2 r), k = kMostNeighbors: a
// kernel estimate whose kernel is constant up to that distance (Loftsgaarden & Quesenberry 1965).
// With G, the geometric mean of r over the map, the neighbourhood has
//   n = sqrt(kFewestNeighbors kMostNeighbors) G / r
// points, at least kFewestNeighbors and at most kMostNeighbors: a point of typical density gets the
// geometric mean of the two. So far from these limits all neighbourhoods have the same length.

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/point_index.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/held_out_returns.h"

namespace plumbline {
namespace {

// Fewest and most points of a neighbourhood, as published.
constexpr int kFewestNeighbors = 10, kMostNeighbors = 50;
// The geometric mean is a scale for the whole map: a sample of points is plenty.
constexpr std::size_t kMaxSampleSize = 10000;
constexpr std::size_t kPointsPerChunk = 4096;

// The map's points, x, y [m], that may be neighbours: held-out returns have no say.
std::vector<double> Neighbors(const SlamGraph& graph, const std::vector<double>& points) {
  std::vector<double> neighbors;
  neighbors.reserve(points.size());
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& scan = graph.scan(s);
    const std::size_t first_held_out = HeldOutReturns::FirstOf(graph, s);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (HeldOutReturns::Contain(r - scan.first_return, first_held_out)) continue;
      neighbors.insert(neighbors.end(), {points[2 * r], points[2 * r + 1]});
    }
  }
  return neighbors;
}

class NearestLineFitter {
 public:
  NearestLineFitter(const SlamGraph& graph, const std::vector<double>& points, ThreadPool* pool)
      : points_(points), neighbors_(Neighbors(graph, points)), index_(neighbors_) {
    EstimateTypicalRadius(pool);
  }

  /// The line of point `i`, zero if there is none. `nearest` is scratch space.
  TangentLine Fit(std::size_t i, std::vector<PointIndex::Neighbor>* nearest) const {
    index_.FindNearest(Point(points_, i), kMostNeighbors, nearest);
    if (nearest->size() < kFewestNeighbors) return {0.0, 0.0, 0.0};
    const double num_points = typical_neighbors_ / std::sqrt(nearest->back().squared_distance);
    PointMoments moments;  // about the point itself
    for (const PointIndex::Neighbor& neighbor : *nearest) {
      if (moments.weight >= kFewestNeighbors && moments.weight >= num_points) break;
      const Eigen::Vector2d offset = Point(neighbors_, neighbor.point) - Point(points_, i);
      moments.Add(offset.x(), offset.y());
    }
    const LineFit fit = FitLine(moments);
    return {fit.normal.x(), fit.normal.y(), fit.normal.dot(Point(points_, i) + fit.centroid)};
  }

 private:
  static Eigen::Vector2d Point(const std::vector<double>& points, std::size_t i) {
    return {points[2 * i], points[2 * i + 1]};
  }

  // n = typical_neighbors_ / r, see the top of the file.
  void EstimateTypicalRadius(ThreadPool* pool) {
    const std::size_t size = points_.size() / 2;
    const std::size_t stride = (size + kMaxSampleSize - 1) / kMaxSampleSize;
    const std::size_t sample_size = stride == 0 ? 0 : (size + stride - 1) / stride;
    std::vector<double> log_radius(sample_size);
    pool->ForEachChunk(sample_size, 256, [&](std::size_t, std::size_t begin, std::size_t end) {
      std::vector<PointIndex::Neighbor> nearest;
      for (std::size_t k = begin; k < end; ++k) {
        index_.FindNearest(Point(points_, k * stride), kMostNeighbors, &nearest);
        log_radius[k] =
            nearest.empty() ? HUGE_VAL : 0.5 * std::log(nearest.back().squared_distance);
      }
    });
    double sum = 0.0, count = 0.0;
    for (const double value : log_radius) {
      if (!std::isfinite(value)) continue;  // All neighbours are in one place.
      sum += value;
      count += 1.0;
    }
    const double typical_radius_m = count > 0.0 ? std::exp(sum / count) : 0.0;
    typical_neighbors_ =
        std::sqrt(static_cast<double>(kFewestNeighbors) * kMostNeighbors) * typical_radius_m;
  }

  const std::vector<double>& points_;
  const std::vector<double> neighbors_;
  PointIndex index_;
  double typical_neighbors_ = 0.0;  // number times distance [m]
};

}  // namespace

TangentLines LinesFromNearest(const SlamGraph& graph, const std::vector<double>& points,
                              ThreadPool* pool) {
  const NearestLineFitter fitter(graph, points, pool);
  std::vector<TangentLine> lines(graph.num_returns());
  std::vector<int> line_of_return(graph.num_returns());
  std::iota(line_of_return.begin(), line_of_return.end(), 0);
  pool->ForEachChunk(lines.size(), kPointsPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       std::vector<PointIndex::Neighbor> nearest;
                       for (std::size_t i = begin; i < end; ++i) {
                         lines[i] = fitter.Fit(i, &nearest);
                       }
                     });
  return {std::move(lines), std::move(line_of_return)};
}

}  // namespace plumbline
