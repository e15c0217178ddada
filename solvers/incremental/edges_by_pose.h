#ifndef PLUMBLINE_SOLVERS_INCREMENTAL_EDGES_BY_POSE_H_
#define PLUMBLINE_SOLVERS_INCREMENTAL_EDGES_BY_POSE_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/terms/pose_edges.h"

namespace plumbline {

/// The residuals of a growing graph's constraints and factors, by pose.
class EdgesByPose {
 public:
  /// Takes in what the graph has gained.
  void Extend(const SlamGraph& graph, const FactorOptions& factors);

  /// Relative poses that say next to nothing from now on, by their indices, see
  /// FactorOptions::ignored_relative_poses; those that were ignored before and are not named count
  /// again.
  void Ignore(const SlamGraph& graph, const std::vector<std::size_t>& ignored);

  const std::vector<PoseEdge>& motions() const { return motions_; }
  const std::vector<PoseEdge>& relative_poses() const { return relative_poses_; }
  const std::vector<CustomFactor>& factors() const { return factors_; }
  /// @{
  /// Those of one pose, ascending: indices into the lists above.
  const std::vector<std::size_t>& MotionsOf(int pose) const { return motions_of_pose_[pose]; }
  const std::vector<std::size_t>& RelativePosesOf(int pose) const {
    return relative_poses_of_pose_[pose];
  }
  const std::vector<std::size_t>& FactorsOf(int pose) const { return factors_of_pose_[pose]; }
  /// @}

 private:
  std::vector<PoseEdge> motions_, relative_poses_;
  std::vector<CustomFactor> factors_;
  std::vector<std::size_t> ignored_;
  std::vector<std::vector<std::size_t>> motions_of_pose_, relative_poses_of_pose_, factors_of_pose_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INCREMENTAL_EDGES_BY_POSE_H_
