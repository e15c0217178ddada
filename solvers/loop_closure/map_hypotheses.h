#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_MAP_HYPOTHESES_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_MAP_HYPOTHESES_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// One explanation of a drive, and the map that it makes.
struct MapHypothesis {
  HypothesisKind kind = HypothesisKind::kMatching;
  SequentialTrajectory start;
  KeyframeGraph keys;
  LoopClosingReport loops;
  std::vector<Pose2> world_from_robot;  ///< per pose of the graph
  MapConsistency consistency;
  std::vector<std::size_t> records;  ///< of it and of its revisions among those that were weighed
};

/// Looks for the explanation of the drive whose map agrees best with itself: from which start,
/// which clusters of closures hold, and which steps are broken. Closures are sought around each
/// start once; after that a hypothesis costs the optimisation of a pose graph and a measurement of
/// the map, and a place is only searched anew where a hypothesis that was adopted moves it to
/// somewhere it was not searched before. The exception is a robot that was carried: the best few
/// places where it may have been get closures of their own.
///
/// The work is bounded: suspects alone are weighed, a fixed number of them per step.
///
/// Relatives: pairwise consistency maximisation (Mangelson et al. 2018), max-mixtures (Olson &
/// Agarwal 2013), switchable constraints and realizing-reversing-recovering (Latif et al. 2013),
/// whose clusters of closures are those of here. What decides there is the error of the graph, here
/// it is what the scans say of free space: two corridors that look alike agree on the graph.
///
/// motion: the noise of the trajectory's odometry. surfaces: of the drive, whose initial poses are
/// those of the odometry as given. ties: null, or the pose graph of a trajectory that is made of
/// several sessions, with closures between them to begin with. Unavailable if progress stopped it.
/// The result does not depend on the number of threads. Collective if processes share the drive;
/// progress must not stop it then. So are all functions of this folder that take surfaces.
Status SearchMapHypotheses(const MotionOptions& motion, const ScanSurfaces& surfaces,
                           const SeedingProgress& progress, ThreadPool* pool,
                           const SequentialTrajectory& matched, const KeyframeGraph* ties,
                           MapHypothesis* best, std::vector<WeighedHypothesis>* weighed);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_MAP_HYPOTHESES_H_
