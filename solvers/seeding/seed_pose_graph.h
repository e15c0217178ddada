#ifndef PLUMBLINE_SOLVERS_SEEDING_SEED_POSE_GRAPH_H_
#define PLUMBLINE_SOLVERS_SEEDING_SEED_POSE_GRAPH_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"

namespace plumbline {

/// The pose graph of the keyframes spread over all poses: one edge from each pose to the next, as
/// the sequential matching left them, then the closures. Constraints name poses of the SLAM graph.
///
/// The steps from one keyframe to the next have equal parts in the error of their edge: chained,
/// their covariances add up to it. Where the edge is broken, the step that leads to the other side
/// has the covariance of the whole broken edge, and the other steps theirs as if it were sound.
/// Before the first keyframe and after the last one the odometry's noise counts.
///
/// trajectory: of the sequential matching. motion: the noise of its odometry.
std::vector<RelativePoseConstraint> SeedPoseGraph(const KeyframeGraph& keys,
                                                  const SequentialTrajectory& trajectory,
                                                  const MotionOptions& motion);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_SEED_POSE_GRAPH_H_
