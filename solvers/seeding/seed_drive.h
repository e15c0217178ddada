#ifndef PLUMBLINE_SOLVERS_SEEDING_SEED_DRIVE_H_
#define PLUMBLINE_SOLVERS_SEEDING_SEED_DRIVE_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// A drive whose scans are matched and whose loops are closed.
struct SeededDrive {
  std::vector<PackedSurface> surfaces;  ///< of the keyframes, per scan (ScanSurfaces::kept)
  SequentialTrajectory matched;         ///< where the loops were closed from
  KeyframeGraph keys;                   ///< with the closures in force
  std::vector<Pose2> world_from_robot;  ///< per pose
};

/// The work of SeedGraph (seed.h), with what it takes to go on closing loops.
Status SeedDrive(const SeedingOptions& options, const MotionOptions& motion,
                 const MeasuredSurface& surface, const SeedingProgress& progress, ThreadPool* pool,
                 const SlamGraph& graph, SeededDrive* drive, SeedingReport* report);

/// The same for a drive that several processes share, each with the scans of a stretch of it
/// (PartitionByTime) to begin with. *part, and its surface with it, is divided anew by where the
/// matching puts the poses (PartitionByPlace). All get the whole drive. Collective; progress cannot
/// stop it.
Status SeedSharedDrive(const SeedingOptions& options, const MotionOptions& motion,
                       const SeedingProgress& progress, ThreadPool* pool, SlamGraph* part,
                       MeasuredSurface* surface, SeededDrive* drive, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_SEED_DRIVE_H_
