// Tangent lines from the nearest neighbours of each point, their number in proportion to the
// density of the map.
//
// Points of a map lie along surfaces, so their density f is counted per metre of surface. It is
// estimated by the distance r to the k-th nearest point, f ~ k / (2 r), k = max_points: a kernel
// estimate whose kernel is constant up to that distance (Loftsgaarden & Quesenberry 1965). With G,
// the geometric mean of r over the map, the neighbourhood has
//   n = sqrt(min_points max_points) G / r
// points, at least min_points and at most max_points: a point of typical density gets the geometric
// mean of the two. So far from these limits all neighbourhoods have the same length.

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/point_index.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/held_out_returns.h"

namespace plumbline {
namespace {

// The geometric mean is a scale for the whole map: a sample of points is plenty.
constexpr std::size_t kMaxSampleSize = 10000;
constexpr std::size_t kPointsPerChunk = 4096;

// The map's points that have a normal, or all where normals have no say, in order of their return
// ids.
struct SurfaceMap {
  std::vector<std::size_t> return_ids;
  std::vector<int> scans;
  std::vector<double> points;            // x, y [m], world
  std::vector<Eigen::Vector2f> normals;  // unit, world; empty where they have no say
  std::vector<std::uint32_t> neighbors;  // the points that may be neighbours, in order

  std::size_t size() const { return return_ids.size(); }
  Eigen::Vector2d point(std::size_t i) const { return {points[2 * i], points[2 * i + 1]}; }
};

SurfaceMap CollectSurface(const SlamGraph& graph, const MapState& state,
                          const std::vector<ReturnNormal>& normals, bool hold_out) {
  SurfaceMap map;
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& scan = graph.scan(s);
    const Eigen::Matrix2f rotation =
        Eigen::Rotation2Dd(state.WorldFromRobot(scan.pose).yaw).toRotationMatrix().cast<float>();
    const std::size_t first_held_out = HeldOutReturns::FirstOf(graph, s);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (!normals.empty() && normals[r].IsNone()) continue;
      if (!hold_out || !HeldOutReturns::Contain(r - scan.first_return, first_held_out)) {
        map.neighbors.push_back(static_cast<std::uint32_t>(map.size()));
      }
      map.return_ids.push_back(r);
      map.scans.push_back(s);
      map.points.insert(map.points.end(), {state.points[2 * r], state.points[2 * r + 1]});
      if (!normals.empty()) map.normals.push_back(rotation * normals[r].Direction().cast<float>());
    }
  }
  return map;
}

std::vector<double> PointsOfNeighbors(const SurfaceMap& map) {
  std::vector<double> points;
  points.reserve(2 * map.neighbors.size());
  for (const std::uint32_t i : map.neighbors) {
    points.insert(points.end(), {map.points[2 * i], map.points[2 * i + 1]});
  }
  return points;
}

class NearestLineFitter {
 public:
  NearestLineFitter(const SurfaceMap& map, const AssociationOptions& options, ThreadPool* pool)
      : map_(map),
        options_(options),
        min_normal_cosine_(std::cos(kMaxNormalAngleRad)),
        index_(PointsOfNeighbors(map)) {
    EstimateTypicalRadius(pool);
  }

  /// The line of point `i`, zero if there is none. `neighbors` is scratch space.
  TangentLine Fit(std::size_t i, std::vector<PointIndex::Neighbor>* neighbors) const {
    index_.FindNearest(map_.point(i), options_.max_points, neighbors);
    const double num_points = typical_neighbors_ / std::sqrt(neighbors->back().squared_distance);
    PointMoments moments;  // about the point itself
    bool enough_poses = !options_.several_poses;
    for (const PointIndex::Neighbor& neighbor : *neighbors) {
      const std::size_t j = map_.neighbors[neighbor.point];
      if (moments.weight >= options_.min_points && moments.weight >= num_points) break;
      if (!FaceTheSameWay(i, j)) continue;
      const Eigen::Vector2d offset = map_.point(j) - map_.point(i);
      moments.Add(offset.x(), offset.y());
      enough_poses = enough_poses || map_.scans[j] != map_.scans[i];
    }
    if (!enough_poses || moments.weight < options_.min_points) return {0.0, 0.0, 0.0};
    return LineThrough(moments, i);
  }

 private:
  bool FaceTheSameWay(std::size_t i, std::size_t j) const {
    return map_.normals.empty() || map_.normals[i].dot(map_.normals[j]) >= min_normal_cosine_;
  }

  // n = typical_neighbors_ / r, see the top of the file.
  void EstimateTypicalRadius(ThreadPool* pool) {
    const std::size_t stride = (map_.size() + kMaxSampleSize - 1) / kMaxSampleSize;
    const std::size_t sample_size = stride == 0 ? 0 : (map_.size() + stride - 1) / stride;
    std::vector<double> log_radius(sample_size);
    pool->ForEachChunk(sample_size, 256, [&](std::size_t, std::size_t begin, std::size_t end) {
      std::vector<PointIndex::Neighbor> neighbors;
      for (std::size_t k = begin; k < end; ++k) {
        index_.FindNearest(map_.point(k * stride), options_.max_points, &neighbors);
        log_radius[k] = 0.5 * std::log(neighbors.back().squared_distance);
      }
    });
    double sum = 0.0, count = 0.0;
    for (const double value : log_radius) {
      if (!std::isfinite(value)) continue;  // All neighbours are in one place.
      sum += value;
      count += 1.0;
    }
    const double typical_radius_m = count > 0.0 ? std::exp(sum / count) : 0.0;
    typical_neighbors_ = std::sqrt(static_cast<double>(options_.min_points) * options_.max_points) *
                         typical_radius_m;
  }

  TangentLine LineThrough(const PointMoments& moments, std::size_t i) const {
    const LineFit fit = FitLine(moments);
    if (fit.EigenvalueRatio() > options_.max_eigenvalue_ratio) return {0.0, 0.0, 0.0};
    const bool same_side =
        map_.normals.empty() || fit.normal.dot(map_.normals[i].cast<double>()) >= 0.0;
    const Eigen::Vector2d normal = same_side ? fit.normal : Eigen::Vector2d(-fit.normal);
    return {normal.x(), normal.y(), normal.dot(map_.point(i) + fit.centroid)};
  }

  const SurfaceMap& map_;
  const AssociationOptions& options_;
  double min_normal_cosine_;
  PointIndex index_;
  double typical_neighbors_ = 0.0;  // number times distance [m]
};

}  // namespace

TangentLines LinesFromNearest(const SlamGraph& graph, const MapState& state,
                              const std::vector<ReturnNormal>& normals,
                              const AssociationOptions& options, ThreadPool* pool, bool hold_out) {
  const SurfaceMap map = CollectSurface(graph, state, normals, hold_out);
  const NearestLineFitter fitter(map, options, pool);
  std::vector<TangentLine> lines(map.size());
  pool->ForEachChunk(map.size(), kPointsPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       std::vector<PointIndex::Neighbor> neighbors;
                       for (std::size_t i = begin; i < end; ++i) {
                         lines[i] = fitter.Fit(i, &neighbors);
                       }
                     });
  std::vector<int> line_of_return(graph.num_returns(), TangentLines::kNone);
  for (std::size_t i = 0; i < map.size(); ++i) {
    line_of_return[map.return_ids[i]] = static_cast<int>(i);
  }
  return {std::move(lines), std::move(line_of_return)};
}

}  // namespace plumbline
