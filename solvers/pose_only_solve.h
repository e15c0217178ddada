#ifndef PLUMBLINE_SOLVERS_POSE_ONLY_SOLVE_H_
#define PLUMBLINE_SOLVERS_POSE_ONLY_SOLVE_H_

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/solver_options.h"
#include "plumbline/solvers/solver_summary.h"

namespace plumbline {

/// Moves the poses of a state down the error of the graph's relative poses, chi2, the sum of their
/// squared whitened errors; odometry and returns are not looked at. Every map point keeps its place
/// in the frame of its robot. Fixed poses stay. The given state comes back, bit for bit, if chi2
/// does not become lower. Expects options that pass Check with a type that MovesPosesOnly(), a
/// finite state at the graph's fixed poses, and relative poses.
///
/// kPoseGraph starts at the given poses or at a chordal start, see refine_pose_graph.h; kSgd starts
/// at the given poses.
SolverSummary SolvePosesOnly(const SolverOptions& options, const SlamGraph& graph, MapState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_ONLY_SOLVE_H_
