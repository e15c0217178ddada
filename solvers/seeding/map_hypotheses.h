#ifndef PLUMBLINE_SOLVERS_SEEDING_MAP_HYPOTHESES_H_
#define PLUMBLINE_SOLVERS_SEEDING_MAP_HYPOTHESES_H_

#include <cstddef>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/close_loops.h"
#include "plumbline/solvers/seeding/loop_closure.h"
#include "plumbline/solvers/seeding/map_consistency.h"
#include "plumbline/solvers/seeding/sequential_seeding.h"
#include "plumbline/solvers/seeding/surface_points.h"

namespace plumbline {

/// What a hypothesis about a drive assumes.
enum class HypothesisKind {
  kMatching,        ///< the sequential matching is right, and so are the loop closures
  kOdometry,        ///< likewise, from the poses that the odometry gave
  kOdometryAlone,   ///< the odometry is right as it is; no loop is closed
  kWithoutCluster,  ///< one cluster of closures is a mistake: two places look alike
  kWithMatch,       ///< a match that is no closure by itself holds: the map is better with it
  kBrokenSteps,     ///< some steps are wrong: a slip, or the robot was carried
  kJoinedParts,     ///< the robot was carried: what lies beyond a step fits at another place
};

const char* ToString(HypothesisKind kind);

/// A hypothesis that was weighed, and how well its map agrees with itself.
struct WeighedHypothesis {
  HypothesisKind kind = HypothesisKind::kMatching;
  /// kWithoutCluster, kWithMatch: poses of the closures in question, at their later and their
  /// earlier ends.
  int first_later_pose = 0, last_later_pose = 0;
  int first_earlier_pose = 0, last_earlier_pose = 0;
  int num_closures = 0;  ///< in force; kWithoutCluster, kWithMatch: in question
  /// kJoinedParts: where the key scan after the step lies, seen from the one before it, and the
  /// first pose after the step.
  Pose2 carried_to;
  int first_pose_after = 0;
  /// Compared and conflicting returns within and between passes.
  FreeSpaceConflict conflict;
  /// Conflicting returns less those that can be explained; the lower, the better. The number is
  /// proportional to the log-likelihood ratio of a map that is right, in which the explicable share
  /// of what is compared conflicts, and one in which passes lie on each other by mistake.
  double score = 0.0;
  bool adopted = false;
  /// The map that it makes: a pose per pose of the graph. kWithoutCluster, kWithMatch: none.
  std::vector<Pose2> world_from_robot;
};

/// One explanation of a drive, and the map that it makes.
struct MapHypothesis {
  HypothesisKind kind = HypothesisKind::kMatching;
  SequentialTrajectory start;
  KeyGraph keys;
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
/// graph: its poses are those of the odometry as given. motion: the noise of the trajectory's
/// odometry. surfaces: per scan. Unavailable if progress stopped it. The result does not depend on
/// the number of threads.
Status SearchMapHypotheses(const MotionOptions& motion, const SlamGraph& graph,
                           const std::vector<SurfacePoints>& surfaces,
                           const SeedingProgress& progress, ThreadPool* pool,
                           const SequentialTrajectory& matched, MapHypothesis* best,
                           std::vector<WeighedHypothesis>* weighed);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_MAP_HYPOTHESES_H_
