#ifndef PLUMBLINE_SOLVERS_CERES_SOLVER_H_
#define PLUMBLINE_SOLVERS_CERES_SOLVER_H_

#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/ceres_options.h"
#include "plumbline/solvers/inner_solve.h"
#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_sightings.h"
#include "plumbline/solvers/reduced/surface_patches.h"
#include "plumbline/solvers/solver_options.h"

namespace plumbline {

/// Minimises the joint energy over all poses and points with Ceres. *state is the best one on
/// return.
InnerResult SolveWithCeres(const SlamGraph& graph, const Associations& associations,
                           const FactorOptions& factors, const CeresOptions& options,
                           int num_threads, const ProgressCallback& report, MapState* state);

/// Minimises the energy over all poses and the lines of patches, points eliminated, for the
/// sightings' weights. `poses`, (x, y, yaw) each, hold the best state on return; the patches keep
/// their lines.
InnerResult SolvePatchesWithCeres(const PatchSightings& sightings,
                                  const std::vector<SurfacePatch>& patches, const PoseTerms& terms,
                                  const CeresOptions& options, int num_threads,
                                  const ProgressCallback& report, std::vector<double>* poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_CERES_SOLVER_H_
