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

/// A return against the line of its landmark, in the frame of its robot.
struct ReturnResidual {
  Eigen::Vector2d z;  ///< the return [m]
  double cosine;      ///< of the angle between its beam and the normal
  double distance;    ///< from the line [m]
  double variance;    ///< of that [m^2]

  ReturnResidual(const ScanReturns& returns, std::size_t return_id, const LineInRobot& line,
                 const SurfaceNoise& noise) {
    const Eigen::Vector2d direction = returns.DirectionInRobot(return_id);
    const double range_m = returns.Range(return_id);
    z = range_m * direction + returns.laser_in_robot();
    cosine = line.normal.dot(direction);
    distance = line.normal.dot(z) + line.offset;
    variance = noise.surface_variance + noise.BeamVariance(range_m, direction, line.normal);
  }
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
