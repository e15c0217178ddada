#include "plumbline/solvers/seeding/local_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr double kBucketM = 0.25;
// Returns from further than this off the first scan's robot do not enter: they would blow up the
// grid, and a match is decided near by.
constexpr double kReachM = 60.0;
constexpr double kMinNormalCosine = 0.7071067811865476;  // 45 degrees

int OctantOf(const Eigen::Vector2d& normal) {
  // Shifted by half an octant: the walls of a building that is aligned with its map must not lie
  // on an edge between two octants.
  const double turns = std::atan2(normal.y(), normal.x()) / (2.0 * kPi);
  return static_cast<int>(std::floor(turns * 8.0 + 0.5)) & 7;
}

}  // namespace

void LocalMap::Rebuild(const std::vector<const SurfacePoints*>& scans,
                       const std::vector<Pose2>& world_from_robot) {
  SurfacePoints raw;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Pose2& pose = world_from_robot[i];
    const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
    Eigen::Matrix2d rotation;
    rotation << c, -s, s, c;
    for (const SurfacePoint& point : *scans[i]) {
      const Eigen::Vector2d position = rotation * point.position + pose.translation();
      const Eigen::Vector2d offset = position - world_from_robot.front().translation();
      if (offset.cwiseAbs().maxCoeff() > kReachM) continue;
      raw.push_back({position, rotation * point.normal});
    }
  }
  AverageCells(&raw);
  IndexPoints();
}

void LocalMap::AverageCells(SurfacePoints* raw) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(raw->size());
  for (std::size_t i = 0; i < raw->size(); ++i) {
    const SurfacePoint& point = (*raw)[i];
    const auto ix = static_cast<std::int64_t>(std::floor(point.position.x() / cell_m_));
    const auto iy = static_cast<std::int64_t>(std::floor(point.position.y() / cell_m_));
    const std::uint64_t cell = (static_cast<std::uint64_t>(ix) & 0x3fffffff) << 30 |
                               (static_cast<std::uint64_t>(iy) & 0x3fffffff);
    keys[i] = {cell << 3 | static_cast<std::uint64_t>(OctantOf(point.normal)),
               static_cast<std::uint32_t>(i)};
  }
  std::sort(keys.begin(), keys.end());
  points_.clear();
  for (std::size_t i = 0; i < keys.size();) {
    Eigen::Vector2d position = Eigen::Vector2d::Zero(), normal = Eigen::Vector2d::Zero();
    std::size_t j = i;
    for (; j < keys.size() && keys[j].first == keys[i].first; ++j) {
      position += (*raw)[keys[j].second].position;
      normal += (*raw)[keys[j].second].normal;
    }
    points_.push_back({position / static_cast<double>(j - i), normal.normalized()});
    i = j;
  }
}

void LocalMap::IndexPoints() {
  width_ = height_ = 0;
  start_.assign(1, 0);
  if (points_.empty()) return;
  Eigen::Vector2d low = points_.front().position, high = low;
  for (const SurfacePoint& point : points_) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  origin_ = low;
  width_ = static_cast<int>((high.x() - low.x()) / kBucketM) + 1;
  height_ = static_cast<int>((high.y() - low.y()) / kBucketM) + 1;
  const auto bucket_of = [&](const SurfacePoint& point) {
    const Eigen::Vector2d offset = (point.position - origin_) / kBucketM;
    return static_cast<int>(offset.y()) * width_ + static_cast<int>(offset.x());
  };
  start_.assign(static_cast<std::size_t>(width_) * height_ + 1, 0);
  for (const SurfacePoint& point : points_) ++start_[bucket_of(point) + 1];
  for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  SurfacePoints sorted(points_.size());
  for (const SurfacePoint& point : points_) sorted[next[bucket_of(point)]++] = point;
  points_.swap(sorted);
}

const SurfacePoint* LocalMap::Nearest(const SurfacePoint& query, double max_distance_m) const {
  const Eigen::Vector2d offset = query.position - origin_;
  const int x_low =
      std::max(0, static_cast<int>(std::floor((offset.x() - max_distance_m) / kBucketM)));
  const int x_high =
      std::min(width_ - 1, static_cast<int>(std::floor((offset.x() + max_distance_m) / kBucketM)));
  const int y_low =
      std::max(0, static_cast<int>(std::floor((offset.y() - max_distance_m) / kBucketM)));
  const int y_high =
      std::min(height_ - 1, static_cast<int>(std::floor((offset.y() + max_distance_m) / kBucketM)));
  const SurfacePoint* best = nullptr;
  double best_squared = max_distance_m * max_distance_m;
  for (int y = y_low; y <= y_high; ++y) {
    if (x_low > x_high) break;
    const int begin = start_[static_cast<std::size_t>(y) * width_ + x_low];
    const int end = start_[static_cast<std::size_t>(y) * width_ + x_high + 1];
    for (int i = begin; i < end; ++i) {
      const SurfacePoint& point = points_[i];
      const double squared = (point.position - query.position).squaredNorm();
      if (squared >= best_squared) continue;
      if (point.normal.dot(query.normal) < kMinNormalCosine) continue;
      best = &point;
      best_squared = squared;
    }
  }
  return best;
}

}  // namespace plumbline
