#include "plumbline/solvers/reduced/gauss_newton_step.h"

#include <cmath>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/reduced/pose_preconditioner.h"

namespace plumbline {

double LandmarkCost::At(const std::vector<double>& poses,
                        const std::vector<PoseFrame>& frames) const {
  const double cost = lines_follow ? FitLandmarkLines(observations, frames, pool, landmarks)
                                   : LandmarkLineCost(observations, frames, *landmarks, pool);
  return cost + terms.Cost(poses);
}

bool LandmarkCost::MoveIfBetter(const std::vector<double>& moved, std::vector<double>* poses,
                                double* cost) const {
  const double moved_cost = At(moved, FramesOf(moved));
  if (!(moved_cost < *cost)) {
    At(*poses, FramesOf(*poses));
    return false;
  }
  *cost = moved_cost;
  *poses = moved;
  return true;
}

GaussNewtonStep TakeGaussNewtonStep(const PoseSystem& system, const LandmarkCost& landmark_cost,
                                    const std::vector<PoseFrame>& frames,
                                    const PoseSystemSolver* linear_solver,
                                    std::vector<double>* poses, double* cost) {
  // Of the right-hand side, in the preconditioner's norm: the re-weighting that follows a step
  // moves the optimum by more.
  constexpr double kCgTolerance = 1e-2;
  // The tolerance ends conjugate gradients long before.
  constexpr int kMaxCgIterations = 200;
  constexpr int kMaxHalvings = 4;
  const LineObservations& observations = landmark_cost.observations;
  const PosePreconditioner preconditioner(system, observations, frames, landmark_cost.pool);
  Eigen::VectorXd step;
  GaussNewtonStep result;
  result.cg_iterations =
      SolvePoseSystemBy(linear_solver, system, observations, preconditioner, -system.gradient,
                        kCgTolerance, kMaxCgIterations, landmark_cost.pool, &step)
          .iterations;
  double length = 1.0;
  for (int attempt = 0; attempt <= kMaxHalvings; ++attempt, length *= 0.5) {
    if (!landmark_cost.MoveIfBetter(system.Moved(*poses, length * step), poses, cost)) continue;
    result.length = length;
    result.norm = length * (system.peers == nullptr
                                ? step.norm()
                                : std::sqrt(SumOverPeers(system.peers, step.squaredNorm())));
    break;
  }
  return result;
}

}  // namespace plumbline
