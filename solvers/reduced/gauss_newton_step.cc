#include "plumbline/solvers/reduced/gauss_newton_step.h"

#include "plumbline/solvers/reduced/pose_preconditioner.h"

namespace plumbline {

GaussNewtonStep TakeGaussNewtonStep(
    const PoseSystem& system, const LineObservations& observations,
    const std::vector<PoseFrame>& frames, double cg_tolerance, const std::vector<double>& poses,
    const std::function<bool(const std::vector<double>& moved)>& move_if_better, ThreadPool* pool) {
  // The tolerance ends conjugate gradients long before.
  constexpr int kMaxCgIterations = 200;
  constexpr int kMaxHalvings = 4;
  const PosePreconditioner preconditioner(system, observations, frames, pool);
  Eigen::VectorXd step;
  GaussNewtonStep result;
  result.cg_iterations = SolvePoseSystem(system, observations, preconditioner, -system.gradient,
                                         cg_tolerance, kMaxCgIterations, pool, &step)
                             .iterations;
  double length = 1.0;
  for (int attempt = 0; attempt <= kMaxHalvings; ++attempt, length *= 0.5) {
    if (!move_if_better(system.Moved(poses, length * step))) continue;
    result.length = length;
    result.norm = length * step.norm();
    break;
  }
  return result;
}

}  // namespace plumbline
