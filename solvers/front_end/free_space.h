#ifndef PLUMBLINE_SOLVERS_FRONT_END_FREE_SPACE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_FREE_SPACE_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// A scan made ready to be compared with many others.
class FreeSpaceScan {
 public:
  FreeSpaceScan(const SlamGraph& graph, int scan);

  /// Looks for returns of `other` in the free space of this scan, given the pose of the other's
  /// robot as seen from this one's. One way only. Where returns conflict, the one in the middle of
  /// them is put into *conflicting_point (may be null), in the frame of this scan's robot [m].
  FreeSpaceConflict Compare(const FreeSpaceScan& other, const Pose2& robot_from_other,
                            Eigen::Vector2d* conflicting_point) const;

 private:
  // bearing_rad: in [-pi, pi].
  double ShortestRange(double bearing_rad) const;

  LaserModel laser_;
  double first_bearing_rad_;  // in [-pi, pi)
  double turn_direction_;     // of the sweep: 1 counter-clockwise, -1 clockwise
  double beams_per_rad_;
  // Per beam: the shortest range [m] of it and the three beams after it, 0 if one has no return. In
  // single precision, as the graph has them.
  std::vector<float> shortest_range_;
  std::vector<Eigen::Vector2d> points_in_robot_;  // of every second return
};

/// The same both ways, given the pose of b's robot as seen from a's.
FreeSpaceConflict CompareBothWays(const FreeSpaceScan& a, const FreeSpaceScan& b,
                                  const Pose2& a_from_b);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_FREE_SPACE_H_
