#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSE_LOOPS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSE_LOOPS_H_

#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/loop_closure/closure_memory.h"

namespace plumbline {

/// The pose graph of a trajectory's keyframes, as the sequential matching left it, without
/// closures.
KeyframeGraph MakeKeyframeGraph(const SequentialTrajectory& trajectory,
                                const MotionOptions& motion);

/// The tie of a keyframe to the one before it, keyframe `from_key`, as the sequential matching left
/// the two.
SequentialEdge MatchedEdge(int from_key, const Keyframe& from, const Keyframe& to,
                           const SequentialTrajectory& trajectory, const MotionOptions& motion);

/// Looks for closures, adds them and moves the keyframes to the optimum of the pose graph, in
/// rounds: each finds what the one before has brought into reach. Closures that the others
/// contradict are dropped again. Closures that the graph has already are kept, as long as nothing
/// contradicts them; what it has refused is not found again. memory: of all that was tested for
/// these keyframes so far; grows. Unavailable if progress stopped it.
Status CloseLoops(const ScanSurfaces& surfaces, const SeedingProgress& progress, ThreadPool* pool,
                  ClosureMemory* memory, KeyframeGraph* keys, LoopClosingReport* report);

/// The same for a graph that has grown: looks for closures from the keyframes `first_key` and later
/// to earlier ones only. Leaves the poses as they are if it finds none.
Status CloseNewLoops(int first_key, const ScanSurfaces& surfaces, const SeedingProgress& progress,
                     ThreadPool* pool, ClosureMemory* memory, KeyframeGraph* keys);

/// Moves the keyframes to the robust optimum of the graph's edges and closures.
void OptimizeKeyframes(KeyframeGraph* keys);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_CLOSE_LOOPS_H_
