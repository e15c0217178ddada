#ifndef PLUMBLINE_APPS_READERS_POSE_GRAPH_LOG_H_
#define PLUMBLINE_APPS_READERS_POSE_GRAPH_LOG_H_

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Makes a log of a pose graph with scans, as if a robot had driven along its poses: those that
/// have scans, in their order, which is not that of time where a map has several drives. The steps
/// from each to the next, by the given poses, take the place of the odometry. Edges are left out: a
/// mapper finds its own.
///
/// max_scans: the first ones are taken; 0: all. InvalidArgument on a graph without returns.
/// Replaces *log on success only.
Status LogOfPoseGraph(const SlamGraph& graph, int max_scans, SlamGraph* log);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_READERS_POSE_GRAPH_LOG_H_
