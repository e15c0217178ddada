// Tangent lines from the nearest neighbours of each point, their number by a density estimate.
//
// Points of a map lie along surfaces, so their density f is counted per metre of surface. Pilot
// estimate: with r the distance to the k-th nearest point, f ~ k / (2 r), k = max_points
// (Loftsgaarden & Quesenberry 1965). The neighbourhood's radius follows Abramson's square-root law
// (Annals of Statistics 10, 1982; Silverman 1986, section 5.3): h = h_0 (f / g)^(-1/2), g the
// geometric mean of f over the map. With G, the geometric mean of r, that is
//   h = h_0 sqrt(r / G),      h_0 = G sqrt(min_points / max_points).
// So a point of typical density gets about sqrt(min_points max_points) neighbours; dense surface
// gets a smaller radius with more points in it, sparse surface a larger one with fewer, and the
// number runs through all of [min_points, max_points] for densities from g times to g over
// max_points / min_points. It is clamped to that interval beyond.

#include <Eigen/Geometry>
#include <cmath>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/point_index.h"
#include "plumbline/solvers/association/associations.h"

namespace plumbline {
namespace {

// The geometric mean is a scale for the whole map: a sample of points is plenty.
constexpr std::size_t kMaxSampleSize = 10000;
constexpr std::size_t kPointsPerChunk = 4096;

// The map's points that have a normal, in order of their return ids.
struct SurfaceMap {
  std::vector<std::size_t> return_ids;
  std::vector<int> scans;
  std::vector<double> points;            // x, y [m], world
  std::vector<Eigen::Vector2f> normals;  // unit, world

  std::size_t size() const { return return_ids.size(); }
  Eigen::Vector2d point(std::size_t i) const { return {points[2 * i], points[2 * i + 1]}; }
};

SurfaceMap CollectSurface(const SlamGraph& graph, const MapState& state,
                          const std::vector<Eigen::Vector2f>& normals) {
  SurfaceMap map;
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& scan = graph.scan(s);
    const Eigen::Matrix2f rotation =
        Eigen::Rotation2Dd(state.WorldFromRobot(scan.pose).yaw).toRotationMatrix().cast<float>();
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (normals[r].isZero()) continue;
      map.return_ids.push_back(r);
      map.scans.push_back(s);
      map.points.insert(map.points.end(), {state.points[2 * r], state.points[2 * r + 1]});
      map.normals.push_back(rotation * normals[r]);
    }
  }
  return map;
}

class NearestLineFitter {
 public:
  NearestLineFitter(const SurfaceMap& map, const AssociationOptions& options, ThreadPool* pool)
      : map_(map),
        options_(options),
        min_normal_cosine_(std::cos(kMaxNormalAngleRad)),
        index_(map.points) {
    EstimateTypicalRadius(pool);
  }

  /// The line of point `i`, zero if there is none. `neighbors` is scratch space.
  TangentLine Fit(std::size_t i, std::vector<PointIndex::Neighbor>* neighbors) const {
    index_.FindNearest(map_.point(i), options_.max_points, neighbors);
    const double radius_squared =
        neighborhood_scale_m_ * std::sqrt(neighbors->back().squared_distance);
    PointMoments moments;  // about the point itself
    bool enough_poses = !options_.several_poses;
    for (const PointIndex::Neighbor& neighbor : *neighbors) {
      const std::size_t j = neighbor.point;
      if (neighbor.squared_distance > radius_squared && moments.weight >= options_.min_points) {
        break;
      }
      if (map_.normals[i].dot(map_.normals[j]) < min_normal_cosine_) continue;
      const Eigen::Vector2d offset = map_.point(j) - map_.point(i);
      moments.Add(offset.x(), offset.y());
      enough_poses = enough_poses || map_.scans[j] != map_.scans[i];
    }
    if (!enough_poses || moments.weight < options_.min_points) return {0.0, 0.0, 0.0};
    return LineThrough(moments, i);
  }

 private:
  // h^2 = neighborhood_scale_m_ * r, see the top of the file.
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
    neighborhood_scale_m_ = typical_radius_m * options_.min_points / options_.max_points;
  }

  TangentLine LineThrough(const PointMoments& moments, std::size_t i) const {
    const LineFit fit = FitLine(moments);
    if (fit.EigenvalueRatio() > options_.max_eigenvalue_ratio) return {0.0, 0.0, 0.0};
    const bool same_side = fit.normal.dot(map_.normals[i].cast<double>()) >= 0.0;
    const Eigen::Vector2d normal = same_side ? fit.normal : Eigen::Vector2d(-fit.normal);
    return {normal.x(), normal.y(), normal.dot(map_.point(i) + fit.centroid)};
  }

  const SurfaceMap& map_;
  const AssociationOptions& options_;
  double min_normal_cosine_;
  PointIndex index_;
  double neighborhood_scale_m_ = 0.0;
};

}  // namespace

std::vector<TangentLine> LinesFromNearest(const SlamGraph& graph, const MapState& state,
                                          const std::vector<Eigen::Vector2f>& normals,
                                          const AssociationOptions& options, ThreadPool* pool) {
  std::vector<TangentLine> lines(graph.num_returns(), TangentLine{0.0, 0.0, 0.0});
  const SurfaceMap map = CollectSurface(graph, state, normals);
  const NearestLineFitter fitter(map, options, pool);
  pool->ForEachChunk(map.size(), kPointsPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       std::vector<PointIndex::Neighbor> neighbors;
                       for (std::size_t i = begin; i < end; ++i) {
                         lines[map.return_ids[i]] = fitter.Fit(i, &neighbors);
                       }
                     });
  return lines;
}

}  // namespace plumbline
