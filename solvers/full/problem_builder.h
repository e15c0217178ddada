#ifndef PLUMBLINE_SOLVERS_FULL_PROBLEM_BUILDER_H_
#define PLUMBLINE_SOLVERS_FULL_PROBLEM_BUILDER_H_

#include <ceres/loss_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// The joint energy as a ceres::Problem whose parameter blocks are a state's own arrays.
struct JointProblem {
  /// Declared before the problem, which uses them until its end.
  std::vector<std::unique_ptr<ceres::LossFunction>> losses;
  std::unique_ptr<ceres::Problem> problem;
  /// For Schur-type linear solvers: group 0 holds the points to eliminate, group 1 all else.
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering;
  /// Residual blocks by term, in the order of MakeTerms, for per-term costs.
  std::vector<std::vector<ceres::ResidualBlockId>> residual_blocks;
};

/// Adds a residual block for every term of the energy. The state must outlive the problem and keep
/// its size.
///
/// A point may be eliminated if no term joins it to another eliminated point. Of the points that a
/// residual joins, all but one stay with the poses. constants: poses that do not move; null: the
/// fixed poses of the graph.
JointProblem BuildJointProblem(const SlamGraph& graph, const Associations& associations,
                               const FactorOptions& options, MapState* state,
                               const std::vector<FixedPose>* constants = nullptr);

/// The energy over poses and the lines of landmarks, points eliminated and weights fixed, as a
/// ceres::Problem whose pose blocks are the caller's own array.
struct LandmarkProblem {
  /// Angle of the normal [rad] and offset [m] of every landmark; begin at the landmarks' lines.
  std::vector<double> lines;
  /// Declared before the problem, which uses them until its end.
  std::vector<std::unique_ptr<ceres::LossFunction>> losses;
  std::unique_ptr<ceres::Problem> problem;
  /// For Schur-type linear solvers: group 0 holds the lines to eliminate, group 1 the poses.
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering;
  /// For inner iterations: the lines alone, all in one group.
  std::shared_ptr<ceres::ParameterBlockOrdering> lines_ordering;
};

/// Adds a residual block for every observation that has weight and for every pose term. `poses`,
/// (x, y, yaw) each, must outlive the problem and keep its size.
LandmarkProblem BuildLandmarkProblem(const LineObservations& observations,
                                     const std::vector<LineLandmark>& landmarks,
                                     const PoseTerms& terms, std::vector<double>* poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_PROBLEM_BUILDER_H_
