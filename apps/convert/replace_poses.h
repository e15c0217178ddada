#ifndef PLUMBLINE_APPS_CONVERT_REPLACE_POSES_H_
#define PLUMBLINE_APPS_CONVERT_REPLACE_POSES_H_

#include <string>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Gives the state of the graph with every pose where a trajectory (a TUM file) has the robot at
/// its time, to kSameTime_s, and the points at the measured ends of the beams. The nearest pose in
/// time counts; but a trajectory with one pose for each of the graph's, in the same order, is taken
/// as it stands, so that scans of one time keep their own poses. Times that the graph does not have
/// are passed over.
///
/// Fails like ReadTumTrajectory and ChoosePairing, and with InvalidArgument if a pose has none of
/// its time, naming the first and the nearest time. *state is then as it was.
Status ReplacePoses(const std::string& trajectory_path, const SlamGraph& graph, MapState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_CONVERT_REPLACE_POSES_H_
