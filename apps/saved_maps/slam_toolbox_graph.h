#ifndef PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_GRAPH_H_
#define PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_GRAPH_H_

#include "plumbline/apps/saved_maps/slam_toolbox_map.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Makes a graph of a saved map: a pose for each scan of GraphScansOf() at its corrected pose and
/// its time; the scan, by the laser of its name; the odometry from each scan of a laser to its
/// next; and the edges, with their covariances. A reading of the laser's range threshold or more is
/// no return, as for slam_toolbox.
///
/// Where odometry and corrected poses differ by more than 1 m or 45 degrees from a scan to the
/// next, the odometry has started anew, as it does in a later session, and is left out;
/// *num_restarts counts that.
///
/// InvalidArgument, naming the file and the scan or edge, on maps without scans, scans of the same
/// id, of an unknown laser or with another number of readings than it has, edges without a
/// measurement or between other scans, what the graph refuses, and scans that no edges connect with
/// the first one. *graph is replaced on success only.
Status BuildGraph(const SlamToolboxMap& map, SlamGraph* graph, int* num_restarts);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_SLAM_TOOLBOX_GRAPH_H_
