#ifndef PLUMBLINE_SOLVERS_LOOP_CLOSURE_MISPLACED_SCANS_H_
#define PLUMBLINE_SOLVERS_LOOP_CLOSURE_MISPLACED_SCANS_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

namespace plumbline {

/// A scan beside where it fits.
struct MisplacedScan {
  int pose = 0;
  Pose2 world_from_robot;  ///< where it fits
};

/// Scans that the map contradicts where they are, and that fit it all but completely some
/// decimetres away. Where wheels slip or the robot is carried along a corridor, the odometry holds
/// poses back. The walls alongside do not object. Door frames and niches do, but they are too far
/// off for a robust term, so no iteration leads out of there.
///
/// Looked at are poses next to steps, up to 16 in a row, that are longer or shorter than by the
/// odometry, by 0.1 m at least and by more than its noise. They are compared with scans near by, of
/// any pass, that are not next to such steps themselves: the neighbours of a misplaced scan may be
/// as wrong as it is. A series of scans that would leap to its place and back again, which the
/// odometry knows nothing of, is left out. Fixed poses stay.
///
/// surfaces: per scan. odometry: from the pose before, per pose. motion: its noise.
/// world_from_robot: per pose. In order of pose. Collective if the graph has peers. The result does
/// not depend on the number of threads.
std::vector<MisplacedScan> FindMisplacedScans(const ScanSurfaces& surfaces,
                                              const std::vector<Pose2>& odometry,
                                              const MotionOptions& motion,
                                              const std::vector<Pose2>& world_from_robot,
                                              ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LOOP_CLOSURE_MISPLACED_SCANS_H_
