#ifndef PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_
#define PLUMBLINE_SOLVERS_REDUCED_POSE_PRECONDITIONER_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_observations.h"
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
/// rigidly about their centre, with the whole of S among them. If the graph is shared, chains and
/// groups end where another process has the poses; all factor the matrix of all groups. Collective
/// then.
class PosePreconditioner {
 public:
  PosePreconditioner(const PoseSystem& system, const LineObservations& observations,
                     const std::vector<PoseFrame>& frames, ThreadPool* pool);

  /// result = P^-1 v, P symmetric positive definite.
  void Apply(const Eigen::VectorXd& v, Eigen::VectorXd* result) const;

 private:
  // Where the poses of one process stand among all groups.
  struct Groups {
    std::vector<int> first_of_rank;  // and the end
    std::size_t size = 1;            // rows, but for the last one of each process
  };

  void FactorChain(const PoseSystem& system);
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
  int GroupOf(std::size_t row) const { return GroupAt(rank_, row); }
  int GroupAt(int rank, std::size_t row) const {
    return groups_.first_of_rank[rank] + static_cast<int>(row / groups_.size);
  }

  const Peers* peers_ = nullptr;
  int rank_ = 0;
  std::vector<PoseFrame> frames_;               // per row
  std::vector<Eigen::Matrix3d> chain_inverse_;  // of the pivots
  std::vector<Eigen::Matrix3d> chain_lower_;    // row i by row i - 1
  Groups groups_;
  std::vector<Eigen::Vector2d> group_center_;  // of all groups
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
