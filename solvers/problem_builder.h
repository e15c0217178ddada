#ifndef PLUMBLINE_SOLVERS_PROBLEM_BUILDER_H_
#define PLUMBLINE_SOLVERS_PROBLEM_BUILDER_H_

#include <ceres/loss_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/energy.h"
#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_sightings.h"
#include "plumbline/solvers/reduced/surface_patches.h"

namespace plumbline {

/// The joint energy as a ceres::Problem whose parameter blocks are a state's own arrays.
struct JointProblem {
  /// Declared before the problem, which uses them until its end.
  std::vector<std::unique_ptr<ceres::LossFunction>> losses;
  std::unique_ptr<ceres::Problem> problem;
  /// For Schur-type linear solvers: group 0 holds the points to eliminate, group 1 all else.
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering;
  /// Residual blocks by term, for per-term costs.
  std::vector<ceres::ResidualBlockId> residual_blocks[kNumTerms];
};

/// Adds a residual block for every term of the energy. The state must outlive the problem and keep
/// its size.
///
/// A point may be eliminated if no term joins it to another eliminated point. Only shape terms
/// join points, two by two; one end of each stays with the poses.
JointProblem BuildJointProblem(const SlamGraph& graph, const Associations& associations,
                               const FactorOptions& options, MapState* state);

/// The energy over poses and the lines of patches, points eliminated and weights fixed, as a
/// ceres::Problem whose pose blocks are the caller's own array.
struct PatchProblem {
  /// Angle of the normal [rad] and offset [m] of every patch; begin at the patches' lines.
  std::vector<double> lines;
  std::unique_ptr<ceres::Problem> problem;
  /// For Schur-type linear solvers: group 0 holds the lines to eliminate, group 1 the poses.
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering;
  /// For inner iterations: the lines alone, all in one group.
  std::shared_ptr<ceres::ParameterBlockOrdering> lines_ordering;
};

/// Adds a residual block for every sighting that has weight and for every pose term. `poses`,
/// (x, y, yaw) each, must outlive the problem and keep its size.
PatchProblem BuildPatchProblem(const PatchSightings& sightings,
                               const std::vector<SurfacePatch>& patches, const PoseTerms& terms,
                               std::vector<double>* poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_PROBLEM_BUILDER_H_
