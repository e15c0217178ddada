#ifndef PLUMBLINE_SOLVERS_SEEDING_SEED_H_
#define PLUMBLINE_SOLVERS_SEEDING_SEED_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/close_loops.h"
#include "plumbline/solvers/seeding/map_consistency.h"
#include "plumbline/solvers/seeding/map_hypotheses.h"
#include "plumbline/solvers/seeding/odometry_noise.h"
#include "plumbline/solvers/seeding/sequential_seeding.h"
#include "plumbline/solvers/solver_options.h"

namespace plumbline {

/// The starting point of the joint estimation, from odometry and scans alone.
struct SeedingOptions {
  SequentialSeedingOptions sequential;  ///< scan matching

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// What the seeding found, and whether to trust it.
struct SeedingReport {
  SequentialSeedingReport sequential;         ///< scan matching
  OdometryNoiseReport odometry_noise;         ///< how the odometry errs, by what the scans say
  LoopClosingReport loops;                    ///< loops closed and refused, and doubtful steps
  MapConsistency consistency;                 ///< of the seed
  std::vector<WeighedHypothesis> hypotheses;  ///< in the order in which they were weighed
  /// The seed's last pose graph, by the graph's poses; see seed_pose_graph.h.
  std::vector<RelativePoseConstraint> pose_graph;
  /// What the odometry should have said of the motion, with a lost sign and significant systematic
  /// errors corrected. SlamGraph::Corrected applies it, and a joint estimation should get that.
  MeasurementCorrections corrections;
  /// world_from_robot of every pose before loops were closed.
  std::vector<Pose2> sequential_poses;
  /// The seed is probably wrong: the map contradicts itself, or the scans before and after a step
  /// disagree and nothing else ties them together; or it contradicts itself a little (a ratio above
  /// 2), and there are doubtful steps or only loops that had to be left open.
  bool alarm = false;

  /// Whether a wrong step of the sequential matching was found and put right.
  bool Repaired() const;
};

/// Finds where scan matching, loop closure and a pose graph put every pose of the graph, starting
/// from the initial guess of the first one: *state has these poses, and the points where the
/// measurements put them from there. Expects poses in order of time, joined by odometry from each
/// pose to the next. The result does not depend on the number of threads. normals: as
/// EstimateReturnNormals gives them. progress may be empty. InvalidArgument on bad options, missing
/// odometry or a wrong number of normals, Unavailable if progress stopped it or an exception was
/// thrown; *state is then as it was.
Status SeedGraph(const SeedingOptions& options, const MotionOptions& motion,
                 const std::vector<Eigen::Vector2f>& normals, const SeedingProgress& progress,
                 ThreadPool* pool, const SlamGraph& graph, MapState* state, SeedingReport* report);

/// The same for a host: noise and threads as Solve will have them, normals by itself, no progress.
Status SeedGraph(const SeedingOptions& options, const SolverOptions& solver_options,
                 const SlamGraph& graph, MapState* state, SeedingReport* report);

/// The second half of it: makes a trajectory of the sequential matching globally consistent by
/// closing its loops. motion: the noise of its odometry. surfaces: per scan, in the frame of the
/// robot.
Status CloseAllLoops(const MotionOptions& motion, const SlamGraph& graph,
                     const std::vector<SurfacePoints>& surfaces, const SeedingProgress& progress,
                     ThreadPool* pool, SequentialTrajectory* trajectory, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_SEED_H_
