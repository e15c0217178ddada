#ifndef PLUMBLINE_SOLVERS_FRONT_END_JOINT_ICP_H_
#define PLUMBLINE_SOLVERS_FRONT_END_JOINT_ICP_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/pairwise_icp.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// Two scans that see the same place, by their poses. Every point of `to` looks for the nearest one
/// of `from`.
struct PairOfScans {
  int from = 0, to = 0;
};

/// Moves all poses at once to where the matched points of all pairs lie on one another, by
/// Gauss-Newton: matches are found anew at each step, within the fine gate of the options, and
/// weighted by Tukey's biweight of that width. Point-to-point or point-to-line, as the options say.
/// links: what ties poses together that no match does; they count under a Cauchy loss. Pose 0
/// stays. surfaces: per pose, in its frame; may be empty. The poses are as they were if a system
/// cannot be solved. The result does not depend on the number of threads.
///
/// Unlike in a graph of relative poses, the matches of two scans change as other scans move them.
void AlignJointly(const PairwiseIcpOptions& options, const std::vector<SurfacePoints>& surfaces,
                  const std::vector<PairOfScans>& pairs,
                  const std::vector<RelativePoseConstraint>& links, ThreadPool* pool,
                  std::vector<Pose2>* world_from_pose);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_JOINT_ICP_H_
