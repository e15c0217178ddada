#ifndef PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_H_
#define PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/peers.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// A 3 x 3 block off the diagonal of a symmetric matrix, by rows of the system.
struct PoseCoupling {
  int from = 0;  ///< columns of its pose
  int to = 0;    ///< rows of its pose
  Eigen::Matrix3d block;
};

/// The same where the scans of one of the two poses are in another process.
struct ForeignCoupling {
  int rank = 0;           ///< of that process
  int pose = 0;           ///< the other pose
  int row = 0;            ///< of this one
  Eigen::Matrix3d block;  ///< its rows, by columns of the other pose
};

/// The rows of one pose in K_p, see below. Moving the pose acts on a line along its normal only, so
/// that the rows of x and y are multiples of each other.
struct LineCoupling {
  Eigen::Vector2d along_normal = Eigen::Vector2d::Zero();  ///< row of a motion along the normal
  Eigen::Vector2d turn = Eigen::Vector2d::Zero();          ///< row of the yaw
  int row = 0;  ///< of the system; kConstant for a pose that has none

  /// normal: of the landmark's line, PoseSystem::line_normal.
  Eigen::Matrix<double, 3, 2> Rows(const Eigen::Vector2d& normal) const {
    Eigen::Matrix<double, 3, 2> rows;
    rows << normal * along_normal.transpose(), turn.transpose();
    return rows;
  }
};

/// The Gauss-Newton system of the poses, the landmarks' lines eliminated:
///   S dx = -gradient,   S = B - sum over landmarks p of K_p K_p^T.
/// B holds what the observations say at fixed lines, block-diagonal, and the terms between poses;
/// the columns of K_p (two per landmark, rows of the poses that see it) are the Schur complement of
/// the line's parameters, which is applied and never formed.
///
/// Constant poses have no rows: a "row" is that of a pose that may move, three numbers each, in the
/// order of the poses. If the graph is shared, each process has the rows of its own poses, and the
/// functions are collective.
struct PoseSystem {
  static constexpr int kConstant = -1;

  const Peers* peers = nullptr;   ///< who has the other rows; null: nobody
  std::vector<int> rank_of_pose;  ///< who has the row of each pose; empty without peers
  /// Where each pose stands among the rows of all processes, in the order of the poses; kConstant
  /// for constant ones. Empty without peers.
  std::vector<int> place_of_pose;
  std::vector<int> pose_of_row;
  std::vector<int> row_of_pose;                  ///< kConstant for constant ones
  std::vector<Eigen::Matrix3d> diagonal;         ///< of B, per row
  std::vector<Eigen::Matrix3d> by_observations;  ///< what the observations give to it
  std::vector<PoseCoupling> couplings;           ///< of B, from < to, in order of (from, to)
  /// Of B: grouped by rank, for each in an order that it has as well.
  std::vector<ForeignCoupling> foreign_couplings;
  std::vector<LineCoupling> line_coupling;   ///< per observation
  std::vector<Eigen::Vector2d> line_normal;  ///< per landmark, as linearised
  /// Per landmark: L^-T, where L L^T is what the returns say of its line, by angle of the normal
  /// [rad] and offset [m]; zero if they do not determine it.
  std::vector<Eigen::Matrix2d> line_whitening;
  Eigen::VectorXd gradient;  ///< 3 per row
  Eigen::VectorXd damping;   ///< what of the diagonal keeps S regular, 3 per row

  /// At poses and the lines that fit them best.
  void Linearize(const LineObservations& observations, const std::vector<LineLandmark>& landmarks,
                 const PoseTerms& terms, const std::vector<double>& poses,
                 const std::vector<PoseFrame>& frames, ThreadPool* pool);

  /// Where a row stands among those of all processes.
  int PlaceOf(int row) const { return peers == nullptr ? row : place_of_pose[pose_of_row[row]]; }

  /// Poses, (x, y, yaw) each, with a step of the rows added.
  std::vector<double> Moved(const std::vector<double>& poses, const Eigen::VectorXd& step) const;

  /// Three rows per pose of the graph from three per row; zero for constant poses.
  Eigen::MatrixXd ByPose(const Eigen::MatrixXd& by_row) const;

  /// S = B from here on: the lines stay where they are, whatever the poses do.
  void HoldLines();

  /// result = S v.
  void Apply(const LineObservations& observations, const Eigen::VectorXd& v, ThreadPool* pool,
             Eigen::VectorXd* result) const;

 private:
  void NumberRows(const PoseTerms& terms);
  void AddObservations(const LineObservations& observations,
                       const std::vector<LineLandmark>& landmarks,
                       const std::vector<PoseFrame>& frames, ThreadPool* pool);
  void AddPoseTerms(const PoseTerms& terms, const std::vector<double>& poses);
  // K_p^T v for the poses of this process.
  Eigen::Vector2d LineOf(const LineObservations& observations, std::size_t p,
                         const Eigen::VectorXd& v) const;
  // What the poses of other processes add to S v.
  void AddForeignPoses(const Eigen::VectorXd& v, Eigen::VectorXd* result) const;

  mutable std::vector<Eigen::VectorXd> part_sums_;  // of K_p K_p^T v, over some landmarks each
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_H_
