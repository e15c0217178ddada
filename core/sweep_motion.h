#ifndef PLUMBLINE_CORE_SWEEP_MOTION_H_
#define PLUMBLINE_CORE_SWEEP_MOTION_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Part of a motion that goes on steadily, straight ahead or along an arc: share 1 is the motion
/// itself, 0 none, 2 twice as long.
Pose2 PartOfMotion(const Pose2& motion, double share);

/// A return by range [m] and bearing [rad] from its laser.
struct BeamReturn {
  double range_m = 0.0;
  double bearing_rad = 0.0;
};

/// The same point, measured from `now`, as seen from where the laser was before. Its bearing is
/// beside the measured one, not a turn away from it.
BeamReturn SeenFromBefore(const BeamReturn& measured, const Pose2& before_from_now);

/// Whether a laser of the graph measures its beams one after the other.
bool HasSweeps(const SlamGraph& graph);

/// Takes out of the returns what the robot moved while its lasers swept: ranges and bearings are
/// those of the same points, seen from where the laser was at the time of the scan. The graph has
/// the measurements as they were taken; poses, (x, y, yaw) each, say where the robot was at the
/// times of the scans. In between it moves steadily from one pose to the next in time, at the last
/// pose as before it. Where those are more than a second apart, or times do not grow, nobody knows
/// how it moved, and the returns stay as they are.
MeasurementCorrections TakeOutSweepMotion(const SlamGraph& measured, SweepOrder order,
                                          const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_SWEEP_MOTION_H_
