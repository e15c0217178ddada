#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_SETS_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_SETS_H_

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace plumbline {

/// Disjoint sets of poses, each named by its smallest.
class PoseSets {
 public:
  explicit PoseSets(std::size_t num_poses) : parent_(num_poses) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  /// The name of the set that the pose is in.
  int Find(int pose) {
    while (parent_[pose] != pose) pose = parent_[pose] = parent_[parent_[pose]];
    return pose;
  }
  void Join(int a, int b) {
    a = Find(a);
    b = Find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_POSE_SETS_H_
