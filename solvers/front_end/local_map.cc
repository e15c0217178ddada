#include "plumbline/solvers/front_end/local_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace plumbline {
namespace {

// Buckets are about this wide: few empty ones, and few points in each.
constexpr double kBucketM = 0.25;
// Returns from further than this off the first scan's robot do not enter: they would blow up the
// grid, and a match is decided near by.
constexpr double kReachM = 60.0;
// 45 degrees and a little more than kMarginRad.
constexpr double kNearlyMinNormalCosine = 0.694;

constexpr int kOctants = 8;

// One of eight sectors of 45 degrees, in no order. The walls of a building that is aligned with its
// map lie in the middle of a sector, not on an edge between two.
int OctantOf(const Eigen::Vector2d& normal) {
  constexpr double kCos = 0.9238795325112867, kSin = 0.3826834323650898;  // 22.5 degrees
  const double x = kCos * normal.x() - kSin * normal.y();
  const double y = kSin * normal.x() + kCos * normal.y();
  return (x > 0.0 ? 4 : 0) | (y > 0.0 ? 2 : 0) | (std::abs(x) > std::abs(y) ? 1 : 0);
}

template <typename Scan>
SurfacePoints PointsInReach(const std::vector<const Scan*>& scans,
                            const std::vector<Pose2>& world_from_robot) {
  std::size_t num_points = 0;
  for (const Scan* scan : scans) num_points += scan->size();
  SurfacePoints points;
  points.reserve(num_points);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const FrameChange world_from_scan(world_from_robot[i]);
    for (std::size_t k = 0; k < scans[i]->size(); ++k) {
      const SurfacePoint in_world = world_from_scan * (*scans[i])[k];
      const Eigen::Vector2d offset = in_world.position - world_from_robot.front().translation();
      if (offset.cwiseAbs().maxCoeff() <= kReachM) points.push_back(in_world);
    }
  }
  return points;
}

}  // namespace

struct LocalMap::Search {
  const SurfacePoint& query;
  double squared_distance;  // to the best so far
  const SurfacePoint* best = nullptr;

  void Offer(const SurfacePoint& point) {
    const double squared = (point.position - query.position).squaredNorm();
    if (squared >= squared_distance || !FacesAlike(query, point)) return;
    best = &point;
    squared_distance = squared;
  }
};

// Also finds how far the next point is that is nearest once the query has turned a little.
struct LocalMap::MarginSearch {
  const SurfacePoint& query;
  double squared_distance;  // to the best so far
  double next_squared_distance;
  const SurfacePoint* best = nullptr;

  void Offer(const SurfacePoint& point) {
    const double squared = (point.position - query.position).squaredNorm();
    if (squared >= std::max(squared_distance, next_squared_distance) || &point == best) return;
    const double cosine = point.normal.dot(query.normal);
    if (cosine < kNearlyMinNormalCosine) return;
    if (squared >= squared_distance || cosine < kMinNormalCosine) {
      next_squared_distance = std::min(next_squared_distance, squared);
      return;
    }
    if (best != nullptr) next_squared_distance = std::min(next_squared_distance, squared_distance);
    best = &point;
    squared_distance = squared;
  }
};

LocalMap::LocalMap(double cell_m)
    : cell_m_(cell_m),
      bucket_shift_(std::max(0, static_cast<int>(std::lround(std::log2(kBucketM / cell_m))))),
      bucket_m_(cell_m * (1 << bucket_shift_)) {}

void LocalMap::Rebuild(const std::vector<const SurfacePoints*>& scans,
                       const std::vector<Pose2>& world_from_robot) {
  RebuildOf(PointsInReach(scans, world_from_robot));
}

void LocalMap::Rebuild(const std::vector<const PackedSurface*>& scans,
                       const std::vector<Pose2>& world_from_robot) {
  RebuildOf(PointsInReach(scans, world_from_robot));
}

void LocalMap::RebuildOf(const SurfacePoints& raw) {
  LayGrid(raw);
  AverageCells(raw, SortIntoBuckets(raw));
}

void LocalMap::LayGrid(const SurfacePoints& raw) {
  width_ = height_ = 0;
  if (raw.empty()) return;
  Eigen::Vector2d low = raw.front().position, high = low;
  for (const SurfacePoint& point : raw) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  // At a multiple of the buckets' size: the cells stay where they are from one map to the next.
  origin_ = bucket_m_ * (low / bucket_m_).array().floor();
  width_ = static_cast<int>((high.x() - origin_.x()) / bucket_m_) + 1;
  height_ = static_cast<int>((high.y() - origin_.y()) / bucket_m_) + 1;
}

// Counts into start_; within a bucket the order stays.
std::vector<LocalMap::RawPoint> LocalMap::SortIntoBuckets(const SurfacePoints& raw) {
  const int side = 1 << bucket_shift_;
  start_.assign(static_cast<std::size_t>(width_) * height_ + 1, 0);
  std::vector<int> bucket_of_point(raw.size()), cell_of_point(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const Eigen::Vector2d at = (raw[i].position - origin_) / cell_m_;
    const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
    bucket_of_point[i] = (y >> bucket_shift_) * width_ + (x >> bucket_shift_);
    cell_of_point[i] =
        ((y & (side - 1)) * side + (x & (side - 1))) * kOctants + OctantOf(raw[i].normal);
    ++start_[bucket_of_point[i] + 1];
  }
  for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  std::vector<RawPoint> sorted(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    sorted[next[bucket_of_point[i]]++] = {static_cast<int>(i), cell_of_point[i]};
  }
  return sorted;
}

// sorted: by bucket, with the bounds of the buckets in start_, which become those of points_.
void LocalMap::AverageCells(const SurfacePoints& raw, const std::vector<RawPoint>& sorted) {
  points_.clear();
  std::vector<int> count;  // of raw points in each of points_
  // The index in points_ of each cell of the bucket at hand. What is less than the bucket's first
  // index is left over from another bucket.
  std::vector<int> index_of_cell(std::size_t{kOctants} << (2 * bucket_shift_), -1);
  int next = 0;
  for (std::size_t b = 0; b + 1 < start_.size(); ++b) {
    const int first_index = static_cast<int>(points_.size());
    start_[b] = first_index;
    for (; next < start_[b + 1]; ++next) {
      const SurfacePoint& point = raw[sorted[next].index];
      int& index = index_of_cell[sorted[next].cell];
      if (index < first_index) {
        index = static_cast<int>(points_.size());
        points_.push_back(point);
        count.push_back(1);
        continue;
      }
      points_[index].position += point.position;
      points_[index].normal += point.normal;
      ++count[index];
    }
  }
  start_.back() = static_cast<int>(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    points_[i].position /= count[i];
    points_[i].normal.normalize();
  }
}

// What the buckets within radius_m of the query hold, and perhaps more.
template <typename AnySearch>
void LocalMap::SearchBuckets(double radius_m, AnySearch* search) const {
  const Eigen::Vector2d at = (search->query.position - origin_) / bucket_m_;
  const double reach = radius_m / bucket_m_;
  const auto index = [](double at, int size) {
    return static_cast<int>(std::clamp(at, -1.0, static_cast<double>(size)));
  };
  const int x_low = std::max(0, index(at.x() - reach, width_));
  const int x_high = std::min(width_ - 1, index(at.x() + reach, width_));
  const int y_low = std::max(0, index(at.y() - reach, height_));
  const int y_high = std::min(height_ - 1, index(at.y() + reach, height_));
  if (x_low > x_high) return;
  for (int y = y_low; y <= y_high; ++y) {
    const int* row = &start_[static_cast<std::size_t>(y) * width_];
    for (int i = row[x_low]; i < row[x_high + 1]; ++i) search->Offer(points_[i]);
  }
}

// A point that makes the rest of a search narrow: the hint, or else one of the query's own bucket.
LocalMap::Search LocalMap::SearchCloseBy(const SurfacePoint& query, double max_distance_m,
                                         const SurfacePoint* hint) const {
  Search search{query, max_distance_m * max_distance_m};
  if (hint != nullptr) search.Offer(*hint);
  if (search.best == nullptr) SearchBuckets(0.0, &search);
  return search;
}

const SurfacePoint* LocalMap::Nearest(const SurfacePoint& query, double max_distance_m,
                                      const SurfacePoint* hint) const {
  Search search = SearchCloseBy(query, max_distance_m, hint);
  SearchBuckets(std::sqrt(search.squared_distance), &search);
  return search.best;
}

LocalMap::Neighbor LocalMap::NearestWithMargin(const SurfacePoint& query, double max_distance_m,
                                               const SurfacePoint* hint) const {
  const Search close = SearchCloseBy(query, max_distance_m, hint);
  const double reach_m = std::sqrt(close.squared_distance) + kMostMarginM;
  MarginSearch search{query, close.squared_distance, reach_m * reach_m, close.best};
  SearchBuckets(reach_m, &search);
  const double next_m = std::sqrt(search.next_squared_distance);
  // A point whose normal is a little farther off may be nearer than the best.
  const double best_m = std::sqrt(search.squared_distance);
  const double share = search.best == nullptr ? 1.0 : 0.5;  // the distance to the best grows, too
  return {search.best, std::max(0.0, share * (next_m - best_m))};
}

}  // namespace plumbline
