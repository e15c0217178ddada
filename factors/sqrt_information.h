#ifndef PLUMBLINE_FACTORS_SQRT_INFORMATION_H_
#define PLUMBLINE_FACTORS_SQRT_INFORMATION_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace plumbline {

/// Turns a covariance Sigma into the upper triangular U with U^T U = Sigma^-1, so that |U e|^2 is
/// the squared Mahalanobis length e^T Sigma^-1 e. The only place that does so.
///
/// Returns false, with *sqrt_information untouched, unless the covariance is finite, symmetric and
/// numerically positive definite.
inline bool SqrtInformation(const Eigen::Matrix3d& covariance, Eigen::Matrix3d* sqrt_information) {
  if (!covariance.allFinite() || !covariance.isApprox(covariance.transpose(), 1e-8)) return false;
  // With rows and columns in reverse order, Sigma = L L^T reads Sigma = V V^T, V upper triangular;
  // U = V^-1 then needs no inverse of Sigma.
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance.reverse());
  if (llt.info() != Eigen::Success) return false;
  const Eigen::Matrix3d v = Eigen::Matrix3d(llt.matrixL()).reverse();
  const Eigen::Matrix3d u = v.triangularView<Eigen::Upper>().solve(Eigen::Matrix3d::Identity());
  if (!u.allFinite()) return false;
  *sqrt_information = u;
  return true;
}

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_SQRT_INFORMATION_H_
