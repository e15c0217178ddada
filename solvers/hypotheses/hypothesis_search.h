#ifndef PLUMBLINE_SOLVERS_HYPOTHESES_HYPOTHESIS_SEARCH_H_
#define PLUMBLINE_SOLVERS_HYPOTHESES_HYPOTHESIS_SEARCH_H_

#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/hypotheses/map_hypothesis.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Searches for the explanation of a drive with the highest posterior: which start is right, which
/// clusters of closures hold, and which steps are wrong. Proposers (proposer.h) suggest hypotheses
/// around the best one so far; the loops of each are closed, its map is measured, and the posterior
/// (posterior.h) alone decides. The search starts again from the first proposer after each
/// improvement, and ends when no proposer has anything new to say or the work is spent.
///
/// Closures are sought around each start once; after that a hypothesis costs the optimisation of a
/// pose graph and a measurement of the map. A place is searched again only where a hypothesis moves
/// it to somewhere it was not searched before.
///
/// Relatives: pairwise consistency maximisation (Mangelson et al. 2018), max-mixtures (Olson &
/// Agarwal 2013), switchable constraints and realizing-reversing-recovering (Latif et al. 2013),
/// from which the clusters of closures are taken. Those decide by the error of the graph. Here the
/// scans decide by free space: a graph cannot tell two similar corridors apart.
///
/// motion: the noise of the trajectory's odometry. surfaces: of the drive, with the poses of the
/// odometry as given for initial poses. ties: null, or the pose graph of a trajectory that is made
/// of several sessions, with closures between them to begin with. weighed: every hypothesis, in
/// order. Unavailable if progress stopped it. The result does not depend on the number of threads.
/// Collective if processes share the drive; progress must not stop it then. This holds for all
/// functions of this folder that take surfaces.
Status SearchMapHypotheses(const MotionOptions& motion, const ScanSurfaces& surfaces,
                           const SeedingProgress& progress, ThreadPool* pool,
                           const SequentialTrajectory& matched, const KeyframeGraph* ties,
                           MapHypothesis* best, std::vector<WeighedHypothesis>* weighed);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_HYPOTHESES_HYPOTHESIS_SEARCH_H_
