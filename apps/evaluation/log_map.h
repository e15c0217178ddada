#ifndef PLUMBLINE_APPS_EVALUATION_LOG_MAP_H_
#define PLUMBLINE_APPS_EVALUATION_LOG_MAP_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// The scans of a log at the poses of a trajectory.
struct LogAtPoses {
  SlamGraph graph;                ///< in the log's order; its initial guesses are these poses
  bool clock_is_useless = false;  ///< scans and poses were paired by order
  std::size_t num_scans_without_pose = 0;
};

/// Reads the log and puts its scans at the poses that have their time (to 1 ms), or scan i at pose
/// i if their times say no more than that, see ChoosePairing. Scans without a pose are left out and
/// counted. Fails and warns like ReadLogIntoGraph; fails like ChoosePairing, and with
/// InvalidArgument if no return has a pose. trajectory_path: to name in errors.
Status ReadLogMap(const std::string& log_path, const std::string& trajectory_path,
                  const std::vector<TimedPose>& trajectory, LogAtPoses* map);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_LOG_MAP_H_
