#ifndef PLUMBLINE_SOLVERS_FRONT_END_MATCH_COVARIANCE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_MATCH_COVARIANCE_H_

#include <Eigen/Core>
#include <Eigen/LU>

namespace plumbline {

/// Neighbouring points of a surface share their errors (the map's, the surface's), so that about
/// this many of them, 0.3 m of surface, count as one.
constexpr double kPointsPerError = 10.0;

/// Covariance (x, y [m], yaw [rad]) of a relative pose found by scan matching, from the points'
/// Gauss-Newton information in the same axes plus what is known otherwise. What all points share is
/// the floor. Where the scan says nothing, as along a bare corridor, the covariance is large.
inline Eigen::Matrix3d MatchCovariance(
    const Eigen::Matrix3d& points_information,
    const Eigen::Matrix3d& other_information = Eigen::Matrix3d::Zero()) {
  constexpr double kFloorM = 0.003;
  constexpr double kFloorRad = 0.001;
  constexpr double kUnknown = 1e-4;  // keeps a match without information invertible
  Eigen::Matrix3d covariance = (points_information / kPointsPerError + other_information +
                                kUnknown * Eigen::Matrix3d::Identity())
                                   .inverse();
  covariance.diagonal() +=
      Eigen::Vector3d(kFloorM * kFloorM, kFloorM * kFloorM, kFloorRad * kFloorRad);
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_MATCH_COVARIANCE_H_
