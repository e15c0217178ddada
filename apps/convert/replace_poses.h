#ifndef PLUMBLINE_APPS_CONVERT_REPLACE_POSES_H_
#define PLUMBLINE_APPS_CONVERT_REPLACE_POSES_H_

#include <string>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Moves every pose of the graph to where a trajectory (a TUM file) has the robot at its time, to
/// kSameTime_s, and the points to the measured ends of the beams. The nearest pose in time counts;
/// but a trajectory with one pose for each of the graph's, in the same order, is taken as it
/// stands, so that scans of one time keep their own poses. Times that the graph does not have are
/// passed over.
///
/// Fails like ReadTumTrajectory and ChoosePairing, and with InvalidArgument if a pose has none of
/// its time, naming the first and the nearest time. The graph is then untouched.
Status ReplacePoses(const std::string& trajectory_path, SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_CONVERT_REPLACE_POSES_H_
