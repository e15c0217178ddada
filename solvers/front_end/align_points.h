#ifndef PLUMBLINE_SOLVERS_FRONT_END_ALIGN_POINTS_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ALIGN_POINTS_H_

#include <Eigen/Core>
#include <cmath>

#include "plumbline/core/pose2.h"

namespace plumbline {

/// The rigid motion map_from_scan that brings matched points closest together in the least-squares
/// sense, in closed form. One point per column [m], paired by index; at least one pair.
inline Pose2 AlignPoints(const Eigen::Ref<const Eigen::Matrix2Xd>& map,
                         const Eigen::Ref<const Eigen::Matrix2Xd>& scan) {
  const Eigen::Vector2d map_mean = map.rowwise().mean(), scan_mean = scan.rowwise().mean();
  const Eigen::Matrix2d correlation =
      (map.colwise() - map_mean) * (scan.colwise() - scan_mean).transpose();
  const Pose2 turn(0.0, 0.0,
                   std::atan2(correlation(1, 0) - correlation(0, 1), correlation.trace()));
  const Eigen::Vector2d shift = map_mean - turn * scan_mean;
  return {shift.x(), shift.y(), turn.yaw};
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ALIGN_POINTS_H_
