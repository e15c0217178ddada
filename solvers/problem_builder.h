#ifndef PLUMBLINE_SOLVERS_PROBLEM_BUILDER_H_
#define PLUMBLINE_SOLVERS_PROBLEM_BUILDER_H_

#include <ceres/loss_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/energy.h"

namespace plumbline {

/// The joint energy as a ceres::Problem whose parameter blocks are the graph's own arrays.
struct JointProblem {
  /// Declared before the problem, which uses them until its end.
  std::vector<std::unique_ptr<ceres::LossFunction>> losses;
  std::unique_ptr<ceres::Problem> problem;
  /// For Schur-type linear solvers: group 0 holds the points to eliminate, group 1 all else.
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering;
  /// Residual blocks by term, for per-term costs.
  std::vector<ceres::ResidualBlockId> residual_blocks[kNumTerms];
};

/// Adds a residual block for every term of the energy. The graph must outlive the problem and keep
/// its numbers of poses and points.
///
/// A point may be eliminated if no term joins it to another eliminated point. Only shape terms
/// join points, two by two; one end of each stays with the poses.
JointProblem BuildJointProblem(const Associations& associations, const FactorOptions& options,
                               SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_PROBLEM_BUILDER_H_
