#ifndef PLUMBLINE_SOLVERS_LANDMARKS_WORLD_MOMENTS_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_WORLD_MOMENTS_H_

#include <Eigen/Core>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/solvers/landmarks/line_observations.h"

namespace plumbline {

/// Adds what an observation's returns amount to in the axes of the world, about an origin there
/// [m], the pose being `frame`.
inline void AddWorldMoments(const LineObservation& s, const PoseFrame& frame,
                            const Eigen::Vector2d& origin, PointMoments* moments) {
  const Eigen::Vector2d point = frame * s.centroid() - origin;
  moments->Add(point.x(), point.y(), s.weight);
  const double cc = frame.c * frame.c, ss = frame.s * frame.s, cs = frame.c * frame.s;
  moments->xx += cc * s.xx - 2.0 * cs * s.xy + ss * s.yy;
  moments->xy += cs * (s.xx - s.yy) + (cc - ss) * s.xy;
  moments->yy += ss * s.xx + 2.0 * cs * s.xy + cc * s.yy;
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_WORLD_MOMENTS_H_
