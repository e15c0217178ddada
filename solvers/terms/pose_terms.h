#ifndef PLUMBLINE_SOLVERS_TERMS_POSE_TERMS_H_
#define PLUMBLINE_SOLVERS_TERMS_POSE_TERMS_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/terms/term.h"

namespace plumbline {

/// The terms of the energy that see poses only, and which poses are constants.
struct PoseTerms {
  PoseTerms() = default;
  PoseTerms(const SlamGraph& graph, const FactorOptions& options);

  /// One half of the sum of squared residuals at `poses`, (x, y, yaw) each; NaN where one is
  /// undefined.
  double Cost(const std::vector<double>& poses) const;

  std::vector<char> is_constant;  ///< per pose: fixed, no solver moves it
  TermList terms;                 ///< in the order of the energy
  /// The graph, if several processes share it (SlamGraph::ShareWith); else null. All have the same
  /// poses and terms.
  const SlamGraph* shared_graph = nullptr;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_POSE_TERMS_H_
