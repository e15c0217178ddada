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

/// Matches a drive from scan to scan, measures the errors of its odometry, and removes the
/// systematic errors from `trajectory->odometry`.
///
/// Given poses with large independent errors (MeasurePoseNoise) are no odometry: each scan is
/// searched for around its pose.
///
/// Odometry with a wrong factor or sign of its translations misleads the matching. The factor is
/// estimated from the scans and removed, and the drive is matched again. If the odometry
/// contradicts the scans even then, or reports no translation, the drive is matched without
/// odometry.
///
/// Where the wheels stand still while the scans move (FindStillWheels), and where the odometry was
/// not measured, steps are predicted.
///
/// motion: noise of the odometry, the prior of the matching. surfaces: surfaces of the drive; keeps
/// the surfaces of the keyframes, see SeedSequentially. Sets `sequential` and `odometry_noise` of
/// the report. Returns Unavailable if progress stopped it. Collective if processes share the drive.
Status MatchDrive(const SeedingOptions& options, const MotionOptions& motion,
                  const SeedingProgress& progress, ThreadPool* pool, ScanSurfaces* surfaces,
                  SequentialTrajectory* trajectory, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_MATCH_DRIVE_H_
