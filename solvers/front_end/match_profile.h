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
/// Door frames, niches and noise decide where a scan fits along a corridor. They give the
/// likelihood many local maxima there, decimetres from each other and nearly as high. Gauss-Newton
/// information describes the one in which the iterations ended, a few centimetres wide, and not
/// the others. So the likelihood is profiled in that direction: the match is repeated at fixed
/// distances along it, up to 1.6 m or until it is hopeless, each pose held there and free
/// otherwise. The best one within 0.6 m becomes the match, and the second moments of all about it
/// add to its covariance. Where the profile falls off within its ends, the information need not say
/// so. A match that the profile and the information know nothing of stays where it is.
///
/// options: those of the match; it is repeated with their fine gate.
Eigen::Matrix3d ProfileMatch(const LocalMap& map, const SurfacePoints& scan,
                             const ScanMatchOptions& options, ScanMatch* match);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_MATCH_PROFILE_H_
