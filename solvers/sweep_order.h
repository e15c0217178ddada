#ifndef PLUMBLINE_SOLVERS_SWEEP_ORDER_H_
#define PLUMBLINE_SOLVERS_SWEEP_ORDER_H_

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/sweep_motion.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// In which order the beams of a laser that sweeps are really measured, at the pace that its model
/// says: the one by which the 200 scans in which the robot turns most by its odometry make the map
/// with the thinnest walls, seeded and refined by each. What the model says stands unless another
/// order makes them thinner by 5 %, as where the robot rests. The result does not depend on the
/// number of threads. Expects poses in order of time, joined by odometry from each to the
/// next or by none.
SweepOrder FindSweepOrder(const SeedingOptions& seeding, const SolverOptions& solver,
                          const SlamGraph& measured, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SWEEP_ORDER_H_
