#ifndef PLUMBLINE_SOLVERS_FULL_CERES_SOLVER_H_
#define PLUMBLINE_SOLVERS_FULL_CERES_SOLVER_H_

#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/interface/inner_result.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// Minimises the joint energy over all poses and points with Ceres. *state is the best one on
/// return. constants: poses that do not move; null: the fixed poses of the graph.
InnerResult SolveWithCeres(const SlamGraph& graph, const Associations& associations,
                           const FactorOptions& factors, const CeresOptions& options,
                           int num_threads, const ProgressCallback& report, MapState* state,
                           const std::vector<FixedPose>* constants = nullptr);

/// Minimises the energy over all poses and the lines of landmarks, points eliminated, for the
/// observations' weights. `poses`, (x, y, yaw) each, hold the best state on return; the landmarks
/// keep their lines.
InnerResult SolveLandmarksWithCeres(const LineObservations& observations,
                                    const std::vector<LineLandmark>& landmarks,
                                    const PoseTerms& terms, const CeresOptions& options,
                                    int num_threads, const ProgressCallback& report,
                                    std::vector<double>* poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_CERES_SOLVER_H_
