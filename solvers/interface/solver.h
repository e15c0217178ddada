#ifndef PLUMBLINE_SOLVERS_INTERFACE_SOLVER_H_
#define PLUMBLINE_SOLVERS_INTERFACE_SOLVER_H_

#include <optional>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

/// What Solve hands to a solver once it has checked its input.
struct SolverProblem {
  const SolverOptions& options;  ///< as given to Solve, checked
  const SlamGraph& graph;        ///< as given to Solve
  /// The surfaces of the graph; null if the caller of Solve has not measured them.
  const MeasuredSurface* surface;
  /// Poses (x, y, yaw) by odometry and relative poses, if these flatly contradict the state, see
  /// constraint_start.h. Never for a solver that moves poses only.
  const std::optional<std::vector<double>>& suggested_poses;
};

/// A way to solve. One object serves any number of calls at a time, and keeps nothing of them. A
/// host that has a minimiser of its own derives from RoundsSolver (rounds_solver.h) instead, which
/// does all but the minimisation.
class Solver {
 public:
  virtual ~Solver() = default;

  /// For summaries and messages.
  virtual const char* name() const = 0;
  /// Whether it looks at relative poses only, so that points just ride along.
  virtual bool MovesPosesOnly() const { return false; }
  /// Whether it cuts surfaces into landmarks and eliminates the points.
  virtual bool IsOverLandmarks() const { return false; }

  /// Puts the best state into *state, which holds the one to start from, and leaves it unchanged if
  /// none is better. May throw: Solve makes it a failure.
  virtual SolverSummary Solve(const SolverProblem& problem, MapState* state) const = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_SOLVER_H_
