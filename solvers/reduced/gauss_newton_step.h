#ifndef PLUMBLINE_SOLVERS_REDUCED_GAUSS_NEWTON_STEP_H_
#define PLUMBLINE_SOLVERS_REDUCED_GAUSS_NEWTON_STEP_H_

#include <functional>
#include <vector>

#include "plumbline/core/pose_frame.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_system.h"

namespace plumbline {

/// How a Gauss-Newton step went.
struct GaussNewtonStep {
  double length = 0.0;    ///< share of the full step; 0: none lowered the cost
  double norm = 0.0;      ///< of what was taken
  int cg_iterations = 0;  ///< of the linear system
};

/// Solves a linearised system by conjugate gradients to a residual of cg_tolerance times the
/// right-hand side, and offers `poses`, (x, y, yaw) each, moved by the step to move_if_better: the
/// whole step first, then half of it, up to four times, until one is taken.
GaussNewtonStep TakeGaussNewtonStep(
    const PoseSystem& system, const LineObservations& observations,
    const std::vector<PoseFrame>& frames, double cg_tolerance, const std::vector<double>& poses,
    const std::function<bool(const std::vector<double>& moved)>& move_if_better, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_GAUSS_NEWTON_STEP_H_
