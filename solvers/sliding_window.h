#ifndef PLUMBLINE_SOLVERS_SLIDING_WINDOW_H_
#define PLUMBLINE_SOLVERS_SLIDING_WINDOW_H_

#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

struct MeasuredSurface;

/// What of a growing graph is refined at a time. Poses that may move are "free"; "fixed" ones hold
/// the map around them.
struct WindowOptions {
  /// SolveWindow: the newest poses that may move. Several times as many as arrive between two
  /// calls, so that each is refined again once its surroundings have been seen from further on.
  int num_free_poses = 300;
  /// Older poses that count, at most, the nearest ones first: those that saw the same as free ones,
  /// up to 20 m from them, one of all that stood and looked the same way. The other ends of
  /// constraints on free poses come on top.
  int max_fixed_poses = 75;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// Refines the newest poses, and their points, against the map of older ones, which stay as they
/// are bit for bit. Like Solve, but its time does not grow with the drive, except for one pass over
/// the lists of poses, scans and constraints. With a window as long as the graph it is Solve.
///
/// Returns count where the graph has them: what the robot moved during a sweep is taken out when
/// the sweep is added (SlamGraph::AddSweep).
///
/// Loops are not for a window: a closure that older poses have to give way to asks for Solve, after
/// a pose graph if they are off by more than a few decimetres.
///
/// The summary speaks of the window: its free and fixed poses, all their returns, and the
/// constraints on free poses. That energy is never worse than before. Poses that FixPose named are
/// held where they were fixed. Free poses that nothing ties to fixed ones keep the first of them.
/// Fails, with the state unchanged, like Solve, and on a graph without poses.
SolverSummary SolveWindow(const SolverOptions& options, const WindowOptions& window,
                          const SlamGraph& graph, MapState* state);

/// The same for a caller that measures the surfaces of scans once, when they arrive: an eighth of
/// the time. surface: of all returns of the graph (MeasureNewScans); of another number of returns:
/// kFailure.
SolverSummary SolveWindow(const SolverOptions& options, const WindowOptions& window,
                          const MeasuredSurface& surface, const SlamGraph& graph, MapState* state);

/// The same for any set of poses: those that are new, or that something has changed for.
/// num_free_poses does not matter here. Fails on an empty set, unknown and repeated ids.
SolverSummary SolvePoses(const SolverOptions& options, const WindowOptions& window,
                         const std::vector<int>& free_poses, const SlamGraph& graph,
                         MapState* state);

/// Adds the scans that the graph has gained to the surface of those before them, which is empty at
/// first. InvalidArgument, with nothing changed, for options out of range and a surface of more
/// returns than the graph has.
Status MeasureNewScans(const SolverOptions& options, const SlamGraph& graph,
                       MeasuredSurface* surface);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SLIDING_WINDOW_H_
