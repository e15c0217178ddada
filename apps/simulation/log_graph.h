#ifndef PLUMBLINE_APPS_SIMULATION_LOG_GRAPH_H_
#define PLUMBLINE_APPS_SIMULATION_LOG_GRAPH_H_

#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a mapper may know of a simulated log: one pose per scan, placed by odometry with the first
/// as the origin of the world; the scan; an odometry constraint from each pose to the next.
/// InvalidArgument if the graph refuses the log; `graph` is then untouched.
Status MakeGraph(const SimulatedLog& log, SlamGraph* graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_LOG_GRAPH_H_
