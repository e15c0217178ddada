#ifndef PLUMBLINE_FACTORS_LANDMARK_SHAPE_FACTOR_H_
#define PLUMBLINE_FACTORS_LANDMARK_SHAPE_FACTOR_H_

#include <Eigen/Core>
#include <cmath>

#include "plumbline/factors/analytic_factor_forward.h"

namespace plumbline {

/// All shape terms of one line landmark: the directions t_k, weights w_k, that adjacent
/// landmarks ask it to have,
///   residual = U n,   U^T U = sum w_k t_k t_k^T,   |residual|^2 = sum_k w_k (n . t_k)^2.
/// Block: line (2: angle of n [rad], offset [m]). Residual: 2, dimensionless. No singularities.
struct LandmarkShapeResidual {
  Eigen::Matrix2d sqrt_terms = Eigen::Matrix2d::Zero();  ///< U, world frame [1/rad]

  /// d_line: 2x2, row-major or null. Returns false if the residual is not finite.
  bool Evaluate(const double* line, double* residuals, double* d_line) const {
    const Eigen::Vector2d normal(std::cos(line[0]), std::sin(line[0]));
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    residual = sqrt_terms * normal;
    if (d_line != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> jacobian(d_line);
      jacobian.col(0) = sqrt_terms * Eigen::Vector2d(-normal.y(), normal.x());
      jacobian.col(1).setZero();
    }
    return residual.allFinite();
  }
};

using LandmarkShapeFactor = AnalyticFactor<LandmarkShapeResidual, 2, 2>;

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_LANDMARK_SHAPE_FACTOR_H_
