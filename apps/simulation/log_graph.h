#ifndef PLUMBLINE_APPS_SIMULATION_LOG_GRAPH_H_
#define PLUMBLINE_APPS_SIMULATION_LOG_GRAPH_H_

#include <vector>

#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a mapper may know of a simulated log: one pose per scan, placed by odometry with the first
/// as the origin of the world; the scan; an odometry constraint from each pose to the next.
/// InvalidArgument if the graph refuses the log; `graph` is then untouched.
Status MakeGraph(const SimulatedLog& log, SlamGraph* graph);

/// Poses and map points in one frame, that of the first pose.
struct MapEstimate {
  std::vector<Pose2> poses;    ///< one per scan
  std::vector<double> points;  ///< x, y [m] per return; NaN where there is none
};

/// True poses and points of a simulated log and the graph that MakeGraph makes of it.
MapEstimate TruthOf(const SimulatedLog& log, const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_LOG_GRAPH_H_
