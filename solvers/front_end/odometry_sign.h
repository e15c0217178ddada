#ifndef PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_SIGN_H_
#define PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_SIGN_H_

#include <vector>

#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/interface/odometry_report.h"

namespace plumbline {

/// Recognises an odometry that lost the sign of its translation: it never goes backwards, and a
/// consistent share of consecutive scans says that the robot did.
/// surfaces: per scan, in the frame of the robot.
OdometrySignReport CheckOdometrySign(const ScanSurfaces& surfaces, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_ODOMETRY_SIGN_H_
