#ifndef PLUMBLINE_SOLVERS_SEEDING_REMATCH_GIVEN_POSES_H_
#define PLUMBLINE_SOLVERS_SEEDING_REMATCH_GIVEN_POSES_H_

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/seeding_options.h"

namespace plumbline {

/// Matches scans anew whose poses were given with independent errors, now against the map of all
/// scans around them: the first matching knew only those before. In rounds: loops are closed, and
/// each scan that fits its surroundings badly is searched for around its given pose, until no scan
/// moves.
///
/// motion: the noise of the steps between given poses. trajectory: of the first matching; only its
/// poses change. Unavailable if progress stopped it. Collective if the graph has
/// peers. The result does not depend on the number of threads.
Status RematchGivenPoses(const MotionOptions& motion, const ScanSurfaces& surfaces,
                         const SeedingProgress& progress, ThreadPool* pool,
                         SequentialTrajectory* trajectory);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_REMATCH_GIVEN_POSES_H_
