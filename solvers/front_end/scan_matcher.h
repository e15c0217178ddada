#ifndef PLUMBLINE_SOLVERS_FRONT_END_SCAN_MATCHER_H_
#define PLUMBLINE_SOLVERS_FRONT_END_SCAN_MATCHER_H_

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/correlative_matcher.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// Point-to-line ICP of one scan against a local map.
struct ScanMatchOptions {
  /// Farthest correspondence [m] in the first iterations: what the prediction may be off by.
  double coarse_gate_m = 0.5;
  /// Farthest correspondence [m] in the last iterations, where only noise is left.
  double fine_gate_m = 0.12;
  int max_iterations = 30;
  /// Standard deviation [m] of a point across its matched surface: range noise, and the errors
  /// that neighbouring points share. It weighs the points against the prior.
  double sigma_m = 0.03;
  /// Iterations end when a step at the fine gate moves the points by less than this [m].
  double step_tolerance_m = 5e-4;
};

/// What is known of a pose before matching: Gaussian about `world_from_robot`, with the
/// information matrix (x, y [m], yaw [rad]) given in the frame of that pose.
struct PosePrediction {
  Pose2 world_from_robot;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

struct ScanMatch {
  Pose2 world_from_robot;
  /// Twice the negative log posterior: squared whitened distances of the points under the robust
  /// loss of the fine gate, plus the squared Mahalanobis distance from the prediction. Compares
  /// predictions of one scan.
  double chi2 = 0.0;
  /// Share of the scan's points within the fine gate of a map surface.
  double inlier_ratio = 0.0;
  /// Gauss-Newton information of the points alone, world axes about the robot's position.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  /// The last step moved the points by less than the tolerance.
  bool converged = false;
};

/// Finds the pose that maximises the posterior of prediction and point-to-line distances. The
/// result is the prediction itself where the map says nothing.
ScanMatch MatchScan(const LocalMap& map, const SurfacePoints& scan,
                    const PosePrediction& prediction, const ScanMatchOptions& options);

/// The matches of a scan from the places in a window where it fits best, at most five, without a
/// prediction. The best place comes first. Empty if the map or the scan is.
std::vector<ScanMatch> MatchInWindow(const LocalMap& map, const SurfacePoints& scan,
                                     const SearchWindow& window);

/// Measures how well a scan fits a map at a given pose, by the fine gate and without a prediction.
ScanMatch MeasureFit(const LocalMap& map, const SurfacePoints& scan, const Pose2& world_from_robot,
                     const ScanMatchOptions& options);

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

#endif  // PLUMBLINE_SOLVERS_FRONT_END_SCAN_MATCHER_H_
