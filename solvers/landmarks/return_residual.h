#ifndef PLUMBLINE_SOLVERS_LANDMARKS_RETURN_RESIDUAL_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_RETURN_RESIDUAL_H_

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/scan_returns.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"

namespace plumbline {

/// A landmark's line in the frame of a robot: distance of z = normal . z + offset.
struct LineInRobot {
  Eigen::Vector2d normal;
  double offset;  ///< [m]

  LineInRobot(const LineLandmark& landmark, const PoseFrame& frame) {
    normal = frame.RotateBack(landmark.normal);
    offset = landmark.normal.dot(frame.translation() - landmark.origin) - landmark.offset_m;
  }
};

/// A return against the line of its landmark, in the frame of its robot. Scalar: double, or an
/// array of them, for as many returns.
template <typename Scalar>
struct ReturnResidualOf {
  Scalar x, y;      ///< the return [m]
  Scalar cosine;    ///< of the angle between its beam and the normal
  Scalar distance;  ///< from the line [m]
  Scalar variance;  ///< of that [m^2]

  /// direction_x, direction_y: of the beam, unit.
  ReturnResidualOf(const Scalar& range_m, const Scalar& direction_x, const Scalar& direction_y,
                   const Eigen::Vector2d& laser, const LineInRobot& line,
                   const SurfaceNoise& noise) {
    const double nx = line.normal.x(), ny = line.normal.y();
    x = range_m * direction_x + laser.x();
    y = range_m * direction_y + laser.y();
    cosine = nx * direction_x + ny * direction_y;
    distance = nx * x + ny * y + line.offset;
    const Scalar across = range_m * (ny * direction_x - nx * direction_y);
    variance = noise.surface_variance + noise.BeamVarianceAt(cosine, across);
  }
};

struct ReturnResidual : ReturnResidualOf<double> {
  ReturnResidual(const ScanReturns& returns, std::size_t return_id, const LineInRobot& line,
                 const SurfaceNoise& noise)
      : ReturnResidual(returns.Range(return_id), returns.DirectionInRobot(return_id),
                       returns.laser_in_robot(), line, noise) {}

 private:
  ReturnResidual(double range_m, const Eigen::Vector2d& direction, const Eigen::Vector2d& laser,
                 const LineInRobot& line, const SurfaceNoise& noise)
      : ReturnResidualOf<double>(range_m, direction.x(), direction.y(), laser, line, noise) {}
};

/// Two returns of one scan, which processors take at once.
struct ReturnPairResidual : ReturnResidualOf<Eigen::Array2d> {
  /// The second one may be the first one again.
  ReturnPairResidual(const ScanReturns& returns, std::size_t first, std::size_t second,
                     const LineInRobot& line, const SurfaceNoise& noise)
      : ReturnPairResidual({returns.Range(first), returns.Range(second)},
                           returns.DirectionInRobot(first), returns.DirectionInRobot(second),
                           returns.laser_in_robot(), line, noise) {}

 private:
  ReturnPairResidual(const Eigen::Array2d& range_m, const Eigen::Vector2d& first,
                     const Eigen::Vector2d& second, const Eigen::Vector2d& laser,
                     const LineInRobot& line, const SurfaceNoise& noise)
      : ReturnResidualOf<Eigen::Array2d>(range_m, {first.x(), second.x()}, {first.y(), second.y()},
                                         laser, line, noise) {}
};

/// Gives an observation the weight, centroid and scatter of weighted returns. moments: about the
/// origin of the robot.
inline void SetMoments(const PointMoments& moments, LineObservation* observation) {
  observation->weight = static_cast<float>(moments.weight);
  Eigen::Vector2d m(moments.x, moments.y);
  if (moments.weight > 0.0) m /= moments.weight;
  observation->center = m.cast<float>();
  observation->xx = static_cast<float>(std::max(0.0, moments.xx - m.x() * moments.x));
  observation->xy = static_cast<float>(moments.xy - m.x() * moments.y);
  observation->yy = static_cast<float>(std::max(0.0, moments.yy - m.y() * moments.y));
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_RETURN_RESIDUAL_H_
