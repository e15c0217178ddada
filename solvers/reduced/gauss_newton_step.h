#ifndef PLUMBLINE_SOLVERS_REDUCED_GAUSS_NEWTON_STEP_H_
#define PLUMBLINE_SOLVERS_REDUCED_GAUSS_NEWTON_STEP_H_

#include <vector>

#include "plumbline/core/pose_frame.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_system.h"
#include "plumbline/solvers/reduced/pose_system_solver.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// What poses cost at fixed weights: the observations of landmarks and the terms between poses.
struct LandmarkCost {
  const LineObservations& observations;
  const PoseTerms& terms;
  bool lines_follow;  ///< refitted to all poses whose cost is asked for, see ReducedOptions
  ThreadPool* pool;
  std::vector<LineLandmark>* landmarks;

  /// frames: of the poses, (x, y, yaw) each.
  double At(const std::vector<double>& poses, const std::vector<PoseFrame>& frames) const;

  /// Takes over poses that cost less, and their cost. Otherwise puts the lines back.
  bool MoveIfBetter(const std::vector<double>& moved, std::vector<double>* poses,
                    double* cost) const;
};

/// How a Gauss-Newton step went.
struct GaussNewtonStep {
  double length = 0.0;    ///< share of the full step; 0: none lowered the cost
  double norm = 0.0;      ///< of what was taken
  int cg_iterations = 0;  ///< of the linear system
};

/// Solves the system, linearised at the poses, by conjugate gradients to a residual of a hundredth
/// of the right-hand side, and moves the poses by the step, or by half of it, up to four times
/// halved, if that lowers the cost. frames: of the poses. linear_solver: null for SolvePoseSystem.
GaussNewtonStep TakeGaussNewtonStep(const PoseSystem& system, const LandmarkCost& landmark_cost,
                                    const std::vector<PoseFrame>& frames,
                                    const PoseSystemSolver* linear_solver,
                                    std::vector<double>* poses, double* cost);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_GAUSS_NEWTON_STEP_H_
