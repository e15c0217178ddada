#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_REMATCH_AT_LEAPS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_REMATCH_AT_LEAPS_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

namespace plumbline {

/// Matches the scans next to each leap anew, without the odometry: where wheels slip, the
/// sequential matching is held back by them for a scan or two before it lets go, and these poses
/// hang behind. A pose is replaced only where its scan fits clearly better, and all but completely,
/// or twice as well, or so that the robot moved more evenly: that many things fit a little
/// somewhere is no reason.
///
/// surfaces: per scan. odometry: from the pose before, per pose. motion: its noise.
/// world_from_robot: per pose, following the keyframes. The result does not depend on the number of
/// threads.
void RematchAtLeaps(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                    const std::vector<Pose2>& odometry, const MotionOptions& motion,
                    ThreadPool* pool, std::vector<Pose2>* world_from_robot);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_REMATCH_AT_LEAPS_H_
