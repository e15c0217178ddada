#ifndef PLUMBLINE_SOLVERS_SEEDING_FREE_SPACE_H_
#define PLUMBLINE_SOLVERS_SEEDING_FREE_SPACE_H_

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Whether returns of one scan lie where another scan looked through.
struct FreeSpaceConflict {
  int num_compared = 0;     ///< returns that the other scan must have seen
  int num_conflicting = 0;  ///< of these, the ones it saw through

  double Share() const {
    return num_compared > 0 ? static_cast<double>(num_conflicting) / num_compared : 0.0;
  }
  FreeSpaceConflict& operator+=(const FreeSpaceConflict& other) {
    num_compared += other.num_compared;
    num_conflicting += other.num_conflicting;
    return *this;
  }
};

/// Compares the returns of `scan` with the beams of `viewer`, given the pose of the scan's robot as
/// seen from the viewer's. One way only.
FreeSpaceConflict CompareFreeSpace(const SlamGraph& graph, int viewer, int scan,
                                   const Pose2& viewer_from_scan);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_FREE_SPACE_H_
