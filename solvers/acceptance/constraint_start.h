#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_CONSTRAINT_START_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_CONSTRAINT_START_H_

#include <optional>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/acceptance/contradicted_edges.h"

namespace plumbline {

/// Where odometry and relative poses put the poses, (x, y, yaw) each, if that is far from where a
/// state has them: their steps from pose to pose contradict its poses by more than three
/// standard deviations, root mean square, as where poses have been mixed up. A step counts for 30
/// of them at most: a single one that is flatly contradicted, as after a robot was carried, does
/// not speak for all. Or if scans contradict relative poses, which may have bent the state: what
/// the scans say takes the place of these, or nothing. Steps are believed, relative poses that join
/// others are downweighted (Cauchy loss): one may be a wrong loop closure. Fixed poses stay.
///
/// Nothing if the steps agree with the state and no relative pose is contradicted, if a pose has no
/// step from the one before, or if the equations cannot be solved.
std::optional<std::vector<double>> StartFromConstraints(
    const SlamGraph& graph, const std::vector<double>& state_poses, const MotionOptions& motion,
    const std::vector<ContradictedEdge>& contradicted = {});

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_CONSTRAINT_START_H_
