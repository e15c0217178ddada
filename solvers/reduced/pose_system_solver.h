#ifndef PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_SOLVER_H_
#define PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_SOLVER_H_

#include <Eigen/Core>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_preconditioner.h"
#include "plumbline/solvers/reduced/pose_system.h"

namespace plumbline {

/// A linear solver in the place of the reduced solver's own conjugate gradients, from an engine
/// that the library does not link to (ReducedOptions::linear_solver). May throw.
class PoseSystemSolver {
 public:
  virtual ~PoseSystemSolver() = default;

  /// What SolvePoseSystem does. Collective if the graph is shared.
  virtual PoseSystemResult Solve(const PoseSystem& system, const LineObservations& observations,
                                 const PosePreconditioner& preconditioner,
                                 const Eigen::VectorXd& right_hand_side, double relative_tolerance,
                                 int max_iterations, ThreadPool* pool,
                                 Eigen::VectorXd* x) const = 0;
};

/// By `linear_solver`, or by SolvePoseSystem if that is null.
inline PoseSystemResult SolvePoseSystemBy(const PoseSystemSolver* linear_solver,
                                          const PoseSystem& system,
                                          const LineObservations& observations,
                                          const PosePreconditioner& preconditioner,
                                          const Eigen::VectorXd& right_hand_side,
                                          double relative_tolerance, int max_iterations,
                                          ThreadPool* pool, Eigen::VectorXd* x) {
  return linear_solver != nullptr
             ? linear_solver->Solve(system, observations, preconditioner, right_hand_side,
                                    relative_tolerance, max_iterations, pool, x)
             : SolvePoseSystem(system, observations, preconditioner, right_hand_side,
                               relative_tolerance, max_iterations, pool, x);
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_SOLVER_H_
