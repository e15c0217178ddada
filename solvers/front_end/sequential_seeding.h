#ifndef PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_SEEDING_H_
#define PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_SEEDING_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// What the sequential matching found. Vectors without another remark have one entry per pose.
struct SequentialTrajectory {
  std::vector<Pose2> world_from_robot;
  /// Odometry from the pose before, with the translation's sign corrected, or what was predicted in
  /// its place; entry 0 is unused.
  std::vector<Pose2> odometry;
  std::vector<Keyframe> keyframes;  ///< in order of time
  /// The poses that were given, if each was searched for around its own; else empty. And their
  /// noise.
  std::vector<Pose2> given_poses;
  PoseNoise given_noise;
  /// Share of the scans that match nothing near by or only far from the odometry, where it is
  /// largest among the stretches that were matched side by side.
  double worst_trouble_share = 0.0;
};

/// What tells where the next scan was taken before it is matched. Both empty: the steps before it
/// (MotionPrediction).
struct StepSource {
  /// Odometry, one step per pose, from the pose before (entry 0 is unused).
  std::vector<Pose2> odometry;
  /// Per pose, whether the step to it is predicted all the same (FindStillWheels); or empty.
  std::vector<char> is_still;
  /// world_from_robot per pose, with independent errors (StepToGivenPose).
  std::vector<Pose2> given_poses;
};

/// Finds the pose of every scan from the ones before it, starting at the initial guess of the first
/// one. Expects poses in order of time, joined by odometry from each pose to the next. If there is
/// none at all, each step is predicted from those before (MotionPrediction), and takes the place of
/// the odometry; `motion` is then the noise of that. Stretches of a long drive with odometry are
/// matched side by side; what comes out does not depend on the number of threads. progress: called
/// on the thread of the caller. surfaces: of the drive; from now on it keeps those of the
/// keyframes.
///
/// Processes that share the drive match side by side, too (collective): each what lies in its part.
/// They all get the whole trajectory, and keep no surfaces.
Status SeedSequentially(const SeedingOptions& options, const MotionOptions& motion,
                        const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
                        SequentialTrajectory* trajectory, SequentialSeedingReport* report);

/// Finds the poses with these steps in place of the graph's odometry.
Status SeedSequentially(const SeedingOptions& options, const MotionOptions& motion,
                        const StepSource& steps, const SeedingProgress& progress, ThreadPool* pool,
                        ScanSurfaces* surfaces, SequentialTrajectory* trajectory,
                        SequentialSeedingReport* report);

/// Returns the steps of a graph's odometry, one per pose, from the pose before (entry 0 is unused),
/// or nothing if the graph has no odometry. InvalidArgument if a step is missing.
Status OdometrySteps(const SlamGraph& graph, std::vector<Pose2>* steps);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_SEEDING_H_
