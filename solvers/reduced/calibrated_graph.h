#ifndef PLUMBLINE_SOLVERS_REDUCED_CALIBRATED_GRAPH_H_
#define PLUMBLINE_SOLVERS_REDUCED_CALIBRATED_GRAPH_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/terms/pose_edges.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {

/// What a calibration may change, each zero for the graph as it was given.
enum CalibrationParameter {
  kMountingX,         ///< [m], added to robot_from_laser of every laser
  kMountingY,         ///< [m]
  kMountingYaw,       ///< [rad]
  kRangeBias,         ///< [m], added to every reading before the scale
  kLogRangeScale,     ///< logarithm of the factor on every range
  kLogOdometryScale,  ///< logarithm of the factor on every translation of the odometry
  kNumCalibrationParameters
};
using CalibrationVector = Eigen::Matrix<double, kNumCalibrationParameters, 1>;
using CalibrationMatrix =
    Eigen::Matrix<double, kNumCalibrationParameters, kNumCalibrationParameters>;
/// Three rows per pose or residual.
using CalibrationRows = Eigen::Matrix<double, 3, kNumCalibrationParameters>;

/// A graph with poses whose sensors can be corrected again and again, always from what it was given
/// with.
///
/// New mountings and range scales are tried with the map in place: the poses are carried along so
/// that every laser stays where it is, on a map that grows with its ranges about the first fixed
/// pose, or the first one of all. So what the returns say of each other does not change with these
/// parameters, only what the odometry and other pose terms say of the poses; no difference of large
/// sums has to tell that. That takes lasers that all have one mounting; the other parameters do not
/// mind.
class CalibratedGraph {
 public:
  /// Keeps a reference to the graph. poses: (x, y, yaw) each.
  CalibratedGraph(const SlamGraph& given, const std::vector<double>& poses);

  /// The given graph with its measurements corrected.
  const SlamGraph& graph() const { return graph_; }
  const MeasurementCorrections& corrections() const { return corrections_; }
  const CalibrationVector& theta() const { return theta_; }
  const std::vector<double>& poses() const { return poses_; }

  /// Corrects mountings, ranges and odometry, and sets the poses.
  void Set(const CalibrationVector& theta, const std::vector<double>& poses);

  /// Takes the noise of the odometry for that of the motion that the poses at hand show. By what it
  /// read, a step that is too long by chance would count less than one that is too short.
  void WeighMotions();

  /// `poses`, which go with theta(), carried along to other parameters.
  std::vector<double> Carried(const CalibrationVector& to, const std::vector<double>& poses) const;

  /// The derivative of Carried for one of the graph's poses, at theta().
  CalibrationRows CarriedBy(int pose) const;

  /// The residuals between poses. Errors of the odometry count in units of what it read: else a
  /// smaller scale would always be a better one.
  PoseEdges Edges(const FactorOptions& factors) const;
  /// The terms of the energy that see poses only, with these residuals.
  PoseTerms Terms(const FactorOptions& factors) const;

  /// The noise of returns, in units of what the laser read, for the same reason.
  SurfaceNoise Noise(const FactorOptions& factors) const;

 private:
  int Anchor() const {
    return graph_.fixed_poses().empty() ? 0 : graph_.fixed_poses().front().pose;
  }
  Pose2 MountingAt(int laser, const CalibrationVector& theta) const;

  const SlamGraph& given_;
  SlamGraph graph_;
  MeasurementCorrections corrections_;
  std::vector<double> poses_;
  CalibrationVector theta_ = CalibrationVector::Zero();
  // As WeighMotions found them, in units of what the odometry read.
  std::vector<Pose2> weighed_motions_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_CALIBRATED_GRAPH_H_
