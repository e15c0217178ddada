#ifndef PLUMBLINE_CORE_POINT_INDEX_H_
#define PLUMBLINE_CORE_POINT_INDEX_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace plumbline {

/// Spatial index over a fixed set of points of the plane: a k-d tree. Queries may run on several
/// threads at once.
class PointIndex {
 public:
  struct Neighbor {
    double squared_distance = 0.0;  ///< [m^2]
    std::uint32_t point = 0;        ///< index into the points, from 0
  };

  /// points: x, y [m] of each point in turn, all finite; fewer than 2^32 points. May be empty.
  explicit PointIndex(std::vector<double> points);
  ~PointIndex();
  PointIndex(PointIndex&&) noexcept;
  PointIndex& operator=(PointIndex&&) noexcept;

  std::size_t size() const;

  /// Finds the `count` points nearest to `query`, or all if there are fewer, and puts them into
  /// `neighbors` by increasing distance (equal distances by index). Which of several points that
  /// are equally far comes last is not specified, but it is the same at every call.
  void FindNearest(const Eigen::Vector2d& query, std::size_t count,
                   std::vector<Neighbor>* neighbors) const;

  /// Finds all points within radius_m of `query`, its edge included, and puts them into `neighbors`
  /// in the same order.
  void FindWithin(const Eigen::Vector2d& query, double radius_m,
                  std::vector<Neighbor>* neighbors) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_POINT_INDEX_H_
