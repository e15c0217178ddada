#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_REMATCH_AT_BREAKS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_REMATCH_AT_BREAKS_H_

#include <vector>

#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

namespace plumbline {

/// Matches the scans next to each broken edge anew, by the odometry from where the way is sound
/// again: the sequential matching had only the map of the wrong place for the first of them.
/// surfaces: per scan. odometry: from the pose before, per pose; motion: its noise.
/// world_from_robot: per pose, following the keyframes.
void RematchAtBreaks(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                     const std::vector<Pose2>& odometry, const MotionOptions& motion,
                     std::vector<Pose2>* world_from_robot);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_REMATCH_AT_BREAKS_H_
