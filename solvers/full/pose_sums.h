#ifndef PLUMBLINE_SOLVERS_FULL_POSE_SUMS_H_
#define PLUMBLINE_SOLVERS_FULL_POSE_SUMS_H_

#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Adds the N values of each scan to those of its pose, in the order of scans: several scans may
/// share a pose, and threads that wrote to it directly would race.
template <int N>
void AddToPoses(const SlamGraph& graph, const std::vector<double>& of_scans,
                std::vector<double>* of_poses) {
  for (int s = 0; s < graph.num_scans(); ++s) {
    double* const sum = &(*of_poses)[N * graph.scan(s).pose];
    for (int i = 0; i < N; ++i) sum[i] += of_scans[N * s + i];
  }
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_POSE_SUMS_H_
