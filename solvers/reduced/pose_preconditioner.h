#ifndef PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_
#define PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/reduced/pose_chain.h"
#include "plumbline/solvers/reduced/pose_system.h"

namespace plumbline {

/// The rows of K_p of one group of poses, moving rigidly.
struct GroupCoupling {
  int group = 0;
  Eigen::Matrix<double, 3, 2> rows = Eigen::Matrix<double, 3, 2>::Zero();
};

/// Two levels, added up, over the rows of the system. Neighbouring poses: the block-tridiagonal
/// part of B, the chain of the odometry with every pose held by the lines. It knows nothing of the
/// slow modes, in which poses carry lines along; for these, groups of consecutive poses that move
/// rigidly about their centre, with the whole of S among them. If the graph is shared, this is
/// collective, and all processes factor the matrix of the groups. It is the same preconditioner,
/// whatever the number of processes.
class PosePreconditioner {
 public:
  PosePreconditioner(const PoseSystem& system, const LineObservations& observations,
                     const std::vector<PoseFrame>& frames, ThreadPool* pool);

  /// result = P^-1 v, P symmetric positive definite.
  void Apply(const Eigen::VectorXd& v, Eigen::VectorXd* result) const;

 private:
  void FormGroups(const PoseSystem& system, const std::vector<PoseFrame>& frames);
  void FactorGroups(const PoseSystem& system, const LineObservations& observations,
                    const std::vector<PoseFrame>& frames, ThreadPool* pool);
  void AddPoseBlocks(const PoseSystem& system, const std::vector<PoseFrame>& frames,
                     Eigen::MatrixXd* matrix) const;
  void AddLandmarks(const PoseSystem& system, const LineObservations& observations,
                    ThreadPool* pool, Eigen::MatrixXd* matrix) const;
  void AddSharedLandmarks(const PoseSystem& system, const LineObservations& observations,
                          Eigen::MatrixXd* matrix) const;
  // How landmark p couples the groups of this process, ascending.
  void CoupleGroups(const PoseSystem& system, const LineObservations& observations, std::size_t p,
                    std::vector<GroupCoupling>* groups) const;
  Eigen::Matrix3d RigidMotion(std::size_t row) const {
    return RigidMotion(frames_[row], GroupOf(row));
  }
  Eigen::Matrix3d RigidMotion(const PoseFrame& frame, int group) const;
  int GroupOf(std::size_t row) const { return group_of_row_[row]; }
  int GroupAt(int place) const { return place / group_size_; }

  const Peers* peers_ = nullptr;
  std::vector<PoseFrame> frames_;  // per row
  PoseChain chain_;
  int group_size_ = 1;
  std::vector<int> group_of_row_;
  std::vector<Eigen::Vector2d> group_center_;
  Eigen::LLT<Eigen::MatrixXd> group_matrix_;
  bool has_groups_ = false;  // not if rounding has made their matrix indefinite
};

struct PoseSystemResult {
  int iterations = 0;
  bool converged = false;  ///< not if iterations ran out or rounding broke them off
};

/// Solves S x = right_hand_side to a residual of relative_tolerance times that, measured in the
/// preconditioner's norm. If the graph is shared, each process gives and gets its own rows.
PoseSystemResult SolvePoseSystem(const PoseSystem& system, const LineObservations& observations,
                                 const PosePreconditioner& preconditioner,
                                 const Eigen::VectorXd& right_hand_side, double relative_tolerance,
                                 int max_iterations, ThreadPool* pool, Eigen::VectorXd* x);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_
