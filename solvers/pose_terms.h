#ifndef PLUMBLINE_SOLVERS_POSE_TERMS_H_
#define PLUMBLINE_SOLVERS_POSE_TERMS_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/relative_pose_factor.h"

namespace plumbline {

/// A residual between two poses of a graph.
struct PoseEdge {
  int from = 0;
  int to = 0;
  RelativePoseResidual residual;
};

/// The terms of the energy that see poses only, ready to evaluate, and which poses are constants.
struct PoseTerms {
  PoseTerms(const SlamGraph& graph, const FactorOptions& options);

  /// One half of the sum of squared residuals at `poses`, (x, y, yaw) each.
  double Cost(const std::vector<double>& poses) const;

  std::vector<char> is_constant;  ///< per pose: fixed, no solver moves it
  std::vector<PoseEdge> motions;
  std::vector<PoseEdge> relative_poses;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_TERMS_H_
