#ifndef PLUMBLINE_SOLVERS_FRONT_END_LOCAL_MAP_H_
#define PLUMBLINE_SOLVERS_FRONT_END_LOCAL_MAP_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// Surface points of several scans in one frame, averaged per small cell and direction of the
/// normal, with a search for the nearest one. Rebuilt whole when its scans change, in time
/// proportional to the number of their points.
class LocalMap {
 public:
  /// Side of a cell [m]: the points of all scans are then a little less dense than those of a
  /// thinned scan.
  static constexpr double kCellM = 0.05;

  /// One averaged point per square of cell_m (1 cm and more) and octant of the normal.
  explicit LocalMap(double cell_m = kCellM);

  /// Replaces the content: scans[i] is seen from world_from_robot[i].
  void Rebuild(const std::vector<const SurfacePoints*>& scans,
               const std::vector<Pose2>& world_from_robot);
  void Rebuild(const std::vector<const PackedSurface*>& scans,
               const std::vector<Pose2>& world_from_robot);

  /// The point nearest to `query` within max_distance_m whose normal is within 45 degrees of the
  /// query's, or null. hint: a point of this map that is perhaps near, as the nearest one before
  /// the query moved, or null; it speeds up the search and, but for ties, does not change what is
  /// found.
  const SurfacePoint* Nearest(const SurfacePoint& query, double max_distance_m,
                              const SurfacePoint* hint = nullptr) const;

  /// The nearest point, and how far the query may move before another one may be nearest.
  struct Neighbor {
    const SurfacePoint* point = nullptr;  ///< null if there is none
    /// While the query has moved by less than this [m] and turned by at most kMarginRad, the
    /// nearest point is the same one, if that is still within max_distance_m and 45 degrees; or
    /// there still is none. At most kMostMarginM.
    double margin_m = 0.0;
  };
  static constexpr double kMostMarginM = 0.02, kMarginRad = 0.0175;

  /// As Nearest. Takes up to twice as long, and pays off where a query moves by less than
  /// kMostMarginM several times.
  Neighbor NearestWithMargin(const SurfacePoint& query, double max_distance_m,
                             const SurfacePoint* hint = nullptr) const;

  /// Whether the normals of a query and of a point of the map are within 45 degrees.
  static bool FacesAlike(const SurfacePoint& query, const SurfacePoint& point) {
    return point.normal.dot(query.normal) >= kMinNormalCosine;
  }

  const SurfacePoints& points() const { return points_; }

 private:
  static constexpr double kMinNormalCosine = 0.7071067811865476;  // 45 degrees

  struct Search;
  struct MarginSearch;
  struct RawPoint {
    int index;
    int cell;  // in its bucket, by direction of the normal
  };

  void RebuildOf(const SurfacePoints& raw);
  void LayGrid(const SurfacePoints& raw);
  std::vector<RawPoint> SortIntoBuckets(const SurfacePoints& raw);
  void AverageCells(const SurfacePoints& raw, const std::vector<RawPoint>& sorted);
  Search SearchCloseBy(const SurfacePoint& query, double max_distance_m,
                       const SurfacePoint* hint) const;
  template <typename AnySearch>
  void SearchBuckets(double radius_m, AnySearch* search) const;

  double cell_m_;
  int bucket_shift_;      // a bucket is a square of 2^bucket_shift_ x 2^bucket_shift_ cells
  double bucket_m_;       // its side
  SurfacePoints points_;  // sorted by bucket
  // Dense grid of buckets over the bounding box; bucket b holds points_[start_[b]] up to
  // points_[start_[b + 1]].
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<int> start_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_LOCAL_MAP_H_
