#ifndef PLUMBLINE_APPS_IO_TRAJECTORY_IO_H_
#define PLUMBLINE_APPS_IO_TRAJECTORY_IO_H_

#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

struct TimedPose {
  double timestamp_s = 0.0;
  Pose2 world_from_robot;
};

/// Every pose of a state with its time, in order of the ids.
std::vector<TimedPose> TrajectoryOf(const SlamGraph& graph, const MapState& state);

/// Writes one line `t x y z qx qy qz qw` per pose, the format of the TUM RGB-D benchmark: time [s]
/// with 6 decimals, position [m] and unit quaternion of world_from_robot with 9.
Status WriteTumTrajectory(const std::string& path, const std::vector<TimedPose>& trajectory);

/// Reads such a file, plain or gzip-compressed, in the file's order; empty lines and comments (#)
/// are skipped. What leaves the plane (z, roll, pitch) is dropped. NotFound or InvalidArgument if
/// the file cannot be read, DataLoss if it is truncated or corrupt; InvalidArgument, naming file,
/// line and field, on anything that is not a finite number or a quaternion whose norm is off by
/// more than 1 %, and if there is no pose.
Status ReadTumTrajectory(const std::string& path, std::vector<TimedPose>* trajectory);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_TRAJECTORY_IO_H_
