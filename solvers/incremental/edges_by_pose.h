#ifndef PLUMBLINE_SOLVERS_INCREMENTAL_EDGES_BY_POSE_H_
#define PLUMBLINE_SOLVERS_INCREMENTAL_EDGES_BY_POSE_H_

#include <cstddef>
#include <memory>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/own_term.h"
#include "plumbline/solvers/terms/pose_edges.h"

namespace plumbline {

/// The residuals of a growing graph's constraints, by pose, and the host's own terms.
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
  /// Their residuals may see poses that the graph does not have yet.
  const std::vector<std::shared_ptr<const OwnTerm>>& own_terms() const { return own_terms_; }
  /// Those of one pose, ascending: indices into the lists above.
  const std::vector<std::size_t>& MotionsOf(int pose) const { return motions_of_pose_[pose]; }
  const std::vector<std::size_t>& RelativePosesOf(int pose) const {
    return relative_poses_of_pose_[pose];
  }

 private:
  std::vector<PoseEdge> motions_, relative_poses_;
  std::vector<std::shared_ptr<const OwnTerm>> own_terms_;
  std::vector<std::size_t> ignored_;
  std::vector<std::vector<std::size_t>> motions_of_pose_, relative_poses_of_pose_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INCREMENTAL_EDGES_BY_POSE_H_
