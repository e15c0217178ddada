#ifndef PLUMBLINE_FACTORS_LINE_OBSERVATION_FACTOR_H_
#define PLUMBLINE_FACTORS_LINE_OBSERVATION_FACTOR_H_

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "plumbline/factors/analytic_factor_forward.h"

namespace plumbline {

/// All returns z_i, weights w_i, that one pose (R, t) has of the tangent line n . (p - origin) =
/// offset. With their sum of weights, centroid and scatter = sum w_i (z_i - centroid)(...)^T,
///   residual = [ sqrt(weight) (n . (R centroid + t - origin) - offset) ; U R^T n ],
///   U^T U = scatter,   |residual|^2 = sum_i w_i (n . (R z_i + t - origin) - offset)^2.
/// The identity is the parallel axis theorem: exact for every pose and line, as long as the
/// weights are fixed.
/// Blocks: world_from_robot (3: x, y [m], yaw [rad]); line (2: angle of n [rad], offset [m]).
/// Residual: 3, dimensionless. No singularities; the angle is unbounded and has period 2 pi.
struct LineObservationResidual {
  double sqrt_weight = 0.0;                                ///< [1/m]
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();      ///< frame of the robot [m]
  Eigen::Matrix2d sqrt_scatter = Eigen::Matrix2d::Zero();  ///< U, frame of the robot
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();        ///< world [m]; fixed

  /// d_pose: 3x3, d_line: 3x2, row-major or null. Returns false if the residual is not finite.
  bool Evaluate(const double* world_from_robot, const double* line, double* residuals,
                double* d_pose, double* d_line) const {
    const double c = std::cos(world_from_robot[2]), s = std::sin(world_from_robot[2]);
    const Eigen::Vector2d normal(std::cos(line[0]), std::sin(line[0]));
    const Eigen::Vector2d from_robot(c * centroid.x() - s * centroid.y(),
                                     s * centroid.x() + c * centroid.y());
    const Eigen::Vector2d point(from_robot.x() + world_from_robot[0] - origin.x(),
                                from_robot.y() + world_from_robot[1] - origin.y());
    const Eigen::Vector2d normal_in_robot(c * normal.x() + s * normal.y(),
                                          c * normal.y() - s * normal.x());
    Eigen::Map<Eigen::Vector3d> residual(residuals);
    residual << sqrt_weight * (normal.dot(point) - line[1]), sqrt_scatter * normal_in_robot;

    // By the angle of the normal; a turn of the robot acts on the scatter with opposite sign.
    const Eigen::Vector2d turn =
        sqrt_scatter * Eigen::Vector2d(-normal_in_robot.y(), normal_in_robot.x());
    if (d_pose != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> jacobian(d_pose);
      const double by_yaw = normal.y() * from_robot.x() - normal.x() * from_robot.y();
      jacobian.row(0) = sqrt_weight * Eigen::RowVector3d(normal.x(), normal.y(), by_yaw);
      jacobian.bottomRows<2>() << 0.0, 0.0, -turn.x(), 0.0, 0.0, -turn.y();
    }
    if (d_line != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 2, Eigen::RowMajor>> jacobian(d_line);
      const double by_angle = normal.x() * point.y() - normal.y() * point.x();
      jacobian.row(0) = sqrt_weight * Eigen::RowVector2d(by_angle, -1.0);
      jacobian.bottomRows<2>() << turn.x(), 0.0, turn.y(), 0.0;
    }
    return residual.allFinite();
  }
};

/// A U with U^T U = scatter, symmetric and positive semi-definite. A negative eigenvalue, which
/// rounding leaves where the returns lie on a line or are one, counts as zero.
inline Eigen::Matrix2d SqrtScatter(const Eigen::Matrix2d& scatter) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(scatter);
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

using LineObservationFactor = AnalyticFactor<LineObservationResidual, 3, 3, 2>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_LINE_OBSERVATION_FACTOR_H_
