#ifndef PLUMBLINE_SOLVERS_FRONT_END_FREE_SPACE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_FREE_SPACE_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/map_consistency.h"

namespace plumbline {

/// What a scan says of one return of another.
enum class ReturnVerdict : char {
  kNotCompared,  ///< does not see the place, or something is in front of it
  kAgrees,       ///< sees a surface there
  kConflicts,    ///< looks through it
};

/// Details of a comparison of two scans.
struct ComparedReturns {
  std::vector<ReturnVerdict> verdicts;  ///< per return of the other scan; none on moving ones
  FreeSpaceConflict with_moving;        ///< the counts with the moving ones
};

/// A scan made ready to be compared with many others.
class FreeSpaceScan {
 public:
  FreeSpaceScan(const SlamGraph& graph, int scan);

  /// Looks for returns of `other` in the free space of this scan, given the pose of the other's
  /// robot as seen from this one's. One way only, and without returns that are marked as moving.
  /// details: may be null.
  FreeSpaceConflict Compare(const FreeSpaceScan& other, const Pose2& robot_from_other,
                            ComparedReturns* details) const;

  /// The returns that are compared, every StrideOf-th of the sweep, in the frame of the robot [m].
  const std::vector<Eigen::Vector2d>& returns() const { return points_in_robot_; }

  /// Number of returns from one that is compared to the next: one per degree at most.
  static std::size_t StrideOf(const LaserModel& laser);

  /// Marks moving returns, by their places in returns(), besides those that the graph knows.
  void MarkMoving(const std::vector<int>& returns);

 private:
  bool Moves(std::size_t place) const { return !moves_.empty() && moves_[place] != 0; }
  // bearing_rad: in [-pi, pi].
  double ShortestRange(double bearing_rad) const;

  LaserModel laser_;
  double first_bearing_rad_;  // in [-pi, pi)
  double turn_direction_;     // of the sweep: 1 counter-clockwise, -1 clockwise
  double beams_per_rad_;
  // Per beam: the shortest range [m] of it and the three beams after it, 0 if one has no return. In
  // single precision, as the graph has them.
  std::vector<float> shortest_range_;
  std::vector<Eigen::Vector2d> points_in_robot_;
  std::vector<char> moves_;  // per point; empty if none does
};

/// Compares two scans both ways, given the pose of b's robot as seen from a's.
FreeSpaceConflict CompareBothWays(const FreeSpaceScan& a, const FreeSpaceScan& b,
                                  const Pose2& a_from_b);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_FREE_SPACE_H_
