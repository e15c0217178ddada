#ifndef PLUMBLINE_SOLVERS_SEEDING_SEQUENTIAL_SEEDING_H_
#define PLUMBLINE_SOLVERS_SEEDING_SEQUENTIAL_SEEDING_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/key_graph.h"
#include "plumbline/solvers/seeding/odometry_sign.h"
#include "plumbline/solvers/seeding/surface_points.h"

namespace plumbline {

/// Sequential point-to-line ICP: each scan is matched against a local map of key scans.
struct SequentialSeedingOptions {
  /// A scan becomes a key scan when no key scan of the local map is within this distance [m] and
  /// this turn [rad] of it: a robot that turns on the spot does not flush its map.
  double key_scan_distance_m = 0.25;
  double key_scan_angle_rad = 0.35;

  bool Check(std::string* error) const;
};

/// What the sequential matching found. Vectors without another remark have one entry per pose.
struct SequentialTrajectory {
  std::vector<Pose2> world_from_robot;
  /// Odometry from the pose before, with the translation's sign corrected; entry 0 is unused.
  std::vector<Pose2> odometry;
  std::vector<KeyScan> key_scans;  ///< in order of time
};

struct SequentialSeedingReport {
  OdometrySignReport odometry_sign;
  int num_key_scans = 0;
  int num_reversed_steps = 0;  ///< steps driven against the odometry's sign
  int num_recovered = 0;       ///< scans that were matched only from a start off the odometry
  /// Scans that follow the odometry: nothing near by fits, or not well enough to believe in a slip.
  int num_unmatched = 0;
};

enum class SeedingPhase { kMatchingScans, kClosingLoops };

/// Called now and then with what has been done of a phase, in scans or in candidates of a round of
/// loop closing; false stops the seeding with an error. num_total 0: nothing is counted, the call
/// only asks whether to go on.
using SeedingProgress = std::function<bool(SeedingPhase phase, int num_done, int num_total)>;

/// Finds the pose of every scan from the ones before it, starting at the initial guess of the first
/// one. Expects poses in order of time, joined by odometry from each pose to the next. surfaces:
/// per scan, in the frame of the robot.
Status SeedSequentially(const SequentialSeedingOptions& options, const MotionOptions& motion,
                        const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                        const SeedingProgress& progress, ThreadPool* pool,
                        SequentialTrajectory* trajectory, SequentialSeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_SEQUENTIAL_SEEDING_H_
