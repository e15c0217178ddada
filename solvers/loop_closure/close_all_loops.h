#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSE_ALL_LOOPS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSE_ALL_LOOPS_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// The second half of the seeding: makes a trajectory of the sequential matching globally
/// consistent by closing its loops. motion: the noise of its odometry. surfaces: per scan, in the
/// frame of the robot.
Status CloseAllLoops(const MotionOptions& motion, const SlamGraph& graph,
                     const std::vector<SurfacePoints>& surfaces, const SeedingProgress& progress,
                     ThreadPool* pool, SequentialTrajectory* trajectory, SeedingReport* report);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSE_ALL_LOOPS_H_
