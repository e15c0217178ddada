#ifndef PLUMBLINE_SOLVERS_SEEDING_SEED_H_
#define PLUMBLINE_SOLVERS_SEEDING_SEED_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/loop_closure.h"
#include "plumbline/solvers/seeding/sequential_seeding.h"

namespace plumbline {

/// The starting point of the joint estimation, from odometry and scans alone.
struct SeedingOptions {
  /// Scans are thinned to one point per this length of surface [m].
  double point_spacing_m = 0.03;
  SequentialSeedingOptions sequential;
  LoopClosureOptions loops;

  bool Check(std::string* error) const;
};

struct SeedingReport {
  SequentialSeedingReport sequential;
  int num_loop_candidates = 0;   ///< pairs of key scans tried, over all rounds
  int num_closures = 0;          ///< accepted and kept
  int num_dropped_closures = 0;  ///< accepted first, then contradicted by the pose graph
};

/// Moves every pose of the graph to where scan matching, loop closure and a pose graph put it,
/// starting from the first pose, and the points with them. Expects poses in order of time, joined
/// by odometry from each pose to the next. Where the odometry is recognised to have lost its sign,
/// its motions are corrected too. The result does not depend on the number of threads.
/// normals: as EstimateReturnNormals gives them. progress may be empty.
/// InvalidArgument on bad options, missing odometry or a wrong number of normals, Unavailable if
/// progress stopped it; the graph is then as it was.
Status SeedGraph(const SeedingOptions& options, const MotionOptions& motion,
                 const std::vector<Eigen::Vector2f>& normals, const SeedingProgress& progress,
                 ThreadPool* pool, SlamGraph* graph, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_SEED_H_
