#ifndef PLUMBLINE_CORE_MAP_POINTS_H_
#define PLUMBLINE_CORE_MAP_POINTS_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// The points of a map, to be read: those of an array, or the measured ones, each placed when it is
/// read. That spares a long log its largest array. Refers to what it is given.
class MapPoints {
 public:
  /// x, y [m] of each point in turn.
  MapPoints(const std::vector<double>& points)  // NOLINT(google-explicit-constructor)
      : points_(&points) {}
  /// The points of SlamGraph::MeasuredMap, without that array. poses: three numbers per pose of the
  /// graph.
  MapPoints(const SlamGraph& graph, const std::vector<double>& poses)
      : graph_(&graph), poses_(&poses) {}
  /// Those of a state; where it has none, those of MeasuredMap.
  MapPoints(const SlamGraph& graph, const MapState& state) {
    *this = state.points.empty() ? MapPoints(graph, state.poses) : MapPoints(state.points);
  }

  std::size_t size() const {
    return points_ != nullptr ? points_->size() / 2 : graph_->num_returns();
  }

  /// A point [m]. ForEach is faster for all of them.
  Eigen::Vector2d At(std::size_t i) const {
    if (points_ != nullptr) return {(*points_)[2 * i], (*points_)[2 * i + 1]};
    const int scan = graph_->ScanOfReturn(i);
    return LaserFrame(scan) * graph_->ReturnsOfScan(scan).PointInLaser(i);
  }

  /// Calls take(index, x, y) for each point in turn.
  template <typename Take>
  void ForEach(const Take& take) const {
    ForEvery(1, take);
  }

  /// The same for every stride-th point, from the first one on.
  template <typename Take>
  void ForEvery(std::size_t stride, const Take& take) const {
    if (points_ != nullptr) {
      for (std::size_t i = 0; i < size(); i += stride) {
        take(i, (*points_)[2 * i], (*points_)[2 * i + 1]);
      }
      return;
    }
    std::size_t next = 0;
    for (int s = 0; s < graph_->num_scans(); ++s) {
      const ScanEntry& scan = graph_->scan(s);
      const std::size_t end = scan.first_return + scan.num_returns;
      if (next >= end) continue;
      const ScanReturns returns = graph_->ReturnsOfScan(s);
      const PoseFrame laser = LaserFrame(s);
      for (; next < end; next += stride) {
        const Eigen::Vector2d point = laser * returns.PointInLaser(next);
        take(next, point.x(), point.y());
      }
    }
  }

 private:
  PoseFrame LaserFrame(int scan) const { return PoseFrame(graph_->WorldFromLaser(scan, *poses_)); }

  const std::vector<double>* points_ = nullptr;  // null: the measured ones
  const SlamGraph* graph_ = nullptr;
  const std::vector<double>* poses_ = nullptr;
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MAP_POINTS_H_
