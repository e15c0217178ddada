#ifndef PLUMBLINE_SOLVERS_SEEDING_CLOSE_ALL_LOOPS_H_
#define PLUMBLINE_SOLVERS_SEEDING_CLOSE_ALL_LOOPS_H_

#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// The second half of the seeding: makes a trajectory of the sequential matching globally
/// consistent by closing its loops, and puts scans where they fit (FindMisplacedScans). motion: the
/// noise of its odometry. surfaces: per scan, in the frame of the robot. ties: see
/// SearchMapHypotheses. keys: becomes the pose graph that its poses follow.
Status CloseAllLoops(const MotionOptions& motion, const ScanSurfaces& surfaces,
                     const SeedingProgress& progress, const KeyframeGraph* ties, ThreadPool* pool,
                     SequentialTrajectory* trajectory, KeyframeGraph* keys, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_CLOSE_ALL_LOOPS_H_
