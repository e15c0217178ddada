#ifndef PLUMBLINE_SOLVERS_SEEDING_LOCAL_MAP_H_
#define PLUMBLINE_SOLVERS_SEEDING_LOCAL_MAP_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/seeding/surface_points.h"

namespace plumbline {

/// Surface points of several scans in one frame, averaged per small cell and direction of the
/// normal, with a search for the nearest one. Rebuilt whole when its scans change, which for a few
/// dozen scans is cheaper than keeping an index up to date.
class LocalMap {
 public:
  /// One averaged point per square of cell_m and octant of the normal.
  explicit LocalMap(double cell_m) : cell_m_(cell_m) {}

  /// Replaces the content: scans[i] is seen from world_from_robot[i].
  void Rebuild(const std::vector<const SurfacePoints*>& scans,
               const std::vector<Pose2>& world_from_robot);

  /// The point nearest to `query` within max_distance_m whose normal is within 45 degrees of the
  /// query's, or null.
  const SurfacePoint* Nearest(const SurfacePoint& query, double max_distance_m) const;

  const SurfacePoints& points() const { return points_; }

 private:
  void AverageCells(SurfacePoints* raw);
  void IndexPoints();

  double cell_m_;
  SurfacePoints points_;  // sorted by bucket
  // Dense grid of square buckets over the bounding box; bucket b holds points_[start_[b]] up to
  // points_[start_[b + 1]].
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<int> start_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_LOCAL_MAP_H_
