#ifndef PLUMBLINE_SOLVERS_SEED_H_
#define PLUMBLINE_SOLVERS_SEED_H_

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

class ThreadPool;

/// Finds where scan matching, loop closure and a pose graph put every pose of the graph, starting
/// from the initial guess of the first one: *state has these poses, and the points where the
/// measurements put them from there. Expects poses in order of time, joined by odometry from each
/// pose to the next, or by none at all: the scans alone then tell how the robot moved. The result
/// does not depend on the number of threads. surface: as MeasureSurface gives it. progress may be
/// empty. InvalidArgument on bad options, a graph that refused a measurement, missing odometry or a
/// wrong number of normals, Unavailable if progress stopped it or an exception was thrown; *state
/// is then as it was.
Status SeedGraph(const SeedingOptions& options, const MotionOptions& motion,
                 const MeasuredSurface& surface, const SeedingProgress& progress, ThreadPool* pool,
                 const SlamGraph& graph, MapState* state, SeedingReport* report);

/// The same for a host: noise and threads as Solve will have them, surface by itself, no progress.
Status SeedGraph(const SeedingOptions& options, const SolverOptions& solver_options,
                 const SlamGraph& graph, MapState* state, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEED_H_
