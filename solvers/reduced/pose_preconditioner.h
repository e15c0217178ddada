#ifndef PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_
#define PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_system.h"

namespace plumbline {

/// Two levels, added up, over the rows of the system. Neighbouring poses: the block-tridiagonal
/// part of B, the chain of the odometry with every pose held by the lines. It knows nothing of the
/// slow modes, in which poses carry lines along; for these, groups of consecutive poses that move
/// rigidly about their centre, with the whole of S among them.
class PosePreconditioner {
 public:
  PosePreconditioner(const PoseSystem& system, const LineObservations& observations,
                     const std::vector<PoseFrame>& frames, ThreadPool* pool);

  /// result = P^-1 v, P symmetric positive definite.
  void Apply(const Eigen::VectorXd& v, Eigen::VectorXd* result) const;

 private:
  void FactorChain(const PoseSystem& system);
  void FactorGroups(const PoseSystem& system, const LineObservations& observations,
                    ThreadPool* pool);
  Eigen::Matrix3d RigidMotion(std::size_t row) const;
  std::size_t GroupOf(std::size_t row) const { return row / group_size_; }

  std::vector<PoseFrame> frames_;               // per row
  std::vector<Eigen::Matrix3d> chain_inverse_;  // of the pivots
  std::vector<Eigen::Matrix3d> chain_lower_;    // row i by row i - 1
  std::size_t group_size_ = 1;
  std::vector<Eigen::Vector2d> group_center_;
  Eigen::LLT<Eigen::MatrixXd> groups_;
  bool has_groups_ = false;  // not if rounding has made their matrix indefinite
};

struct PoseSystemResult {
  int iterations = 0;
  bool converged = false;  ///< not if iterations ran out or rounding broke them off
};

/// Solves S x = right_hand_side to a residual of relative_tolerance times that, measured in the
/// preconditioner's norm.
PoseSystemResult SolvePoseSystem(const PoseSystem& system, const LineObservations& observations,
                                 const PosePreconditioner& preconditioner,
                                 const Eigen::VectorXd& right_hand_side, double relative_tolerance,
                                 int max_iterations, ThreadPool* pool, Eigen::VectorXd* x);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_
