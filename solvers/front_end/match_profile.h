#ifndef PLUMBLINE_SOLVERS_FRONT_END_MATCH_PROFILE_H_
#define PLUMBLINE_SOLVERS_FRONT_END_MATCH_PROFILE_H_

#include <Eigen/Core>

#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/front_end/surface_points.h"

namespace plumbline {

/// Covariance (x, y [m], yaw [rad]; axes of the map) of a match that was found without a
/// prediction. *match becomes the best pose along the direction in which it is known worst.
///
/// Along a corridor, door frames, niches and noise give the likelihood of a scan's pose many local
/// maxima, decimetres from each other and nearly as high. Gauss-Newton information describes only
/// the one in which the iterations ended. So the likelihood is profiled in that direction: the
/// match is repeated at fixed distances along it, up to 1.6 m or until it is hopeless, each pose
/// held there and free otherwise. The best one within 0.6 m becomes the match, and the second
/// moments of all about it add to its covariance. A match that neither the profile nor the
/// information determines stays where it is.
///
/// options: those of the match; it is repeated with their fine gate.
Eigen::Matrix3d ProfileMatch(const LocalMap& map, const SurfacePoints& scan,
                             const ScanMatchOptions& options, ScanMatch* match);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_MATCH_PROFILE_H_
