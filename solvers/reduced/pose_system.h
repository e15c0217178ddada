#ifndef PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_H_
#define PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_sightings.h"
#include "plumbline/solvers/reduced/surface_patches.h"

namespace plumbline {

/// Moves every patch's line to where it fits best: the principal component of its sightings'
/// moments, placed by the poses. Gives the cost of all sightings at these lines.
double FitPatchLines(const PatchSightings& sightings, const std::vector<PoseFrame>& frames,
                     ThreadPool* pool, std::vector<SurfacePatch>* patches);

/// The cost of all sightings at the lines as they are.
double PatchLineCost(const PatchSightings& sightings, const std::vector<PoseFrame>& frames,
                     const std::vector<SurfacePatch>& patches, ThreadPool* pool);

/// A 3 x 3 block off the diagonal of a symmetric matrix, by rows of the system.
struct PoseCoupling {
  int from = 0;  ///< columns of its pose
  int to = 0;    ///< rows of its pose
  Eigen::Matrix3d block;
};

/// The rows of one pose in K_p, see below.
struct LineCoupling {
  Eigen::Matrix<double, 3, 2> rows;
  int row = 0;  ///< of the system; kConstant for a pose that has none
};

/// The Gauss-Newton system of the poses, the patches' lines eliminated:
///   S dx = -gradient,   S = B - sum over patches p of K_p K_p^T.
/// B holds what the sightings say at fixed lines, block-diagonal, and the terms between poses; the
/// columns of K_p (two per patch, rows of the poses that see it) are the Schur complement of the
/// line's parameters, which is applied and never formed.
///
/// Constant poses have no rows: a "row" is that of a pose that may move, three numbers each, in the
/// order of the poses.
struct PoseSystem {
  static constexpr int kConstant = -1;

  std::vector<int> pose_of_row;
  std::vector<int> row_of_pose;               ///< kConstant for constant ones
  std::vector<Eigen::Matrix3d> diagonal;      ///< of B, per row
  std::vector<Eigen::Matrix3d> by_sightings;  ///< what the sightings give to it
  std::vector<PoseCoupling> couplings;        ///< of B, from < to, in order of (from, to)
  std::vector<LineCoupling> line_coupling;    ///< per sighting
  /// Per patch: L^-T, where L L^T is what the returns say of its line, by angle of the normal [rad]
  /// and offset [m]; zero if they do not determine it.
  std::vector<Eigen::Matrix2d> line_whitening;
  Eigen::VectorXd gradient;  ///< 3 per row
  Eigen::VectorXd damping;   ///< what of the diagonal keeps S regular, 3 per row

  /// At poses and the lines that fit them best.
  void Linearize(const PatchSightings& sightings, const std::vector<SurfacePatch>& patches,
                 const PoseTerms& terms, const std::vector<double>& poses,
                 const std::vector<PoseFrame>& frames, ThreadPool* pool);

  /// Poses, (x, y, yaw) each, with a step of the rows added.
  std::vector<double> Moved(const std::vector<double>& poses, const Eigen::VectorXd& step) const;

  /// Three rows per pose from three per row; zero for constant poses.
  Eigen::MatrixXd ByPose(const Eigen::MatrixXd& by_row) const;

  /// S = B from here on: the lines stay where they are, whatever the poses do.
  void HoldLines();

  /// result = S v.
  void Apply(const PatchSightings& sightings, const Eigen::VectorXd& v, ThreadPool* pool,
             Eigen::VectorXd* result) const;

 private:
  void NumberRows(const std::vector<char>& is_constant);
  void AddSightings(const PatchSightings& sightings, const std::vector<SurfacePatch>& patches,
                    const std::vector<PoseFrame>& frames, ThreadPool* pool);
  void AddPoseTerms(const PoseTerms& terms, const std::vector<double>& poses);

  mutable std::vector<Eigen::VectorXd> part_sums_;  // of K_p K_p^T v, over some patches each
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_POSE_SYSTEM_H_
