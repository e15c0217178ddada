#ifndef PLUMBLINE_SOLVERS_FRONT_END_MATCH_DRIVE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_MATCH_DRIVE_H_

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// Matches a drive from scan to scan, measures the errors of its odometry, and takes the systematic
/// ones out of `trajectory->odometry`.
///
/// Odometry whose translations are off by a factor, or turned round, pulls the matching along: the
/// factor is estimated from the scans, taken out, and the drive is matched again. If the odometry
/// still contradicts the scans then, or reports no translation at all, the drive is matched as one
/// without odometry.
///
/// motion: noise of the odometry as a prior of the matching. surfaces: of the drive; keeps those of
/// the keyframes, see SeedSequentially. Sets the `sequential` and `odometry_noise` of the report.
/// Unavailable if progress stopped it. Collective if processes share the drive.
Status MatchDrive(const SeedingOptions& options, const MotionOptions& motion,
                  const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
                  SequentialTrajectory* trajectory, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_MATCH_DRIVE_H_
