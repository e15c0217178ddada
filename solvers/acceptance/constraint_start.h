#ifndef PLUMBLINE_SOLVERS_ACCEPTANCE_CONSTRAINT_START_H_
#define PLUMBLINE_SOLVERS_ACCEPTANCE_CONSTRAINT_START_H_

#include <optional>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/acceptance/contradicted_edges.h"

namespace plumbline {

/// Puts the poses, (x, y, yaw) each, where odometry and relative poses have them, if
///
/// - that is far from a state: its steps from pose to pose contradict the state by more than three
///   standard deviations, root mean square, as where poses have been mixed up. Each step counts for
///   30 at most: one alone, as after a robot was carried, does not speak for all; or
/// - scans contradict relative poses, which may have bent the state. The match of the scans takes
///   their place, if there is one.
///
/// Steps are believed, relative poses that join others are downweighted (Cauchy loss): one may be a
/// wrong loop closure. Fixed poses stay. Nothing if neither is the case, if a pose has no step from
/// the one before, or if the equations cannot be solved.
std::optional<std::vector<double>> StartFromConstraints(
    const SlamGraph& graph, const std::vector<double>& state_poses, const MotionOptions& motion,
    const std::vector<ContradictedEdge>& contradicted = {});

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ACCEPTANCE_CONSTRAINT_START_H_
