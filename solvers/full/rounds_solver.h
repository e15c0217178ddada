#ifndef PLUMBLINE_SOLVERS_FULL_ROUNDS_SOLVER_H_
#define PLUMBLINE_SOLVERS_FULL_ROUNDS_SOLVER_H_

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/full/energy.h"
#include "plumbline/solvers/interface/inner_result.h"
#include "plumbline/solvers/interface/solver.h"

namespace plumbline {

/// The joint energy of one set of associations, in its parts and as a function.
struct RoundProblem {
  const SolverOptions& options;      ///< as given to Solve
  const SlamGraph& graph;            ///< as given to Solve
  const Associations& associations;  ///< of this round: lines and pairs, fixed
  const FactorOptions& factors;      ///< of this round: early ones have wider robust gates
  /// Of the graph, the associations and the factors above. Its constants are the fixed poses of the
  /// graph. But there are none if a single pose is fixed, constraints tie all others to it, and no
  /// custom factor says where the map lies: then the tangent lines hold the map for the round,
  /// which moved as a whole afterwards, so that the pose is in place.
  const Energy& energy;
};

/// A solver that works in rounds (RoundOptions): each finds what belongs together in the map, and
/// minimises the energy of that. All but the minimisation is done here: the rounds, the choice of
/// the best one, and the acceptance test against the given state.
///
/// To have Solve run a minimiser of your own, derive from this and set SolverOptions::own_solver.
class RoundsSolver : public Solver {
 public:
  /// All of a solve, with Minimize in each round.
  SolverSummary Solve(const SolverProblem& problem, MapState* state) const final;

  /// Lowers the energy. *state is where to start, and on return the best state seen. Calls `report`
  /// after each iteration, if it is not empty; once that returns false, ends with
  /// InnerResult::stopped. The poses of Energy::constants must not change.
  virtual InnerResult Minimize(const RoundProblem& problem, const ProgressCallback& report,
                               MapState* state) const = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_ROUNDS_SOLVER_H_
