#ifndef PLUMBLINE_CORE_GRAPH_POSES_H_
#define PLUMBLINE_CORE_GRAPH_POSES_H_

#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// world_from_robot of every pose of the graph.
inline std::vector<Pose2> PosesOf(const SlamGraph& graph) {
  std::vector<Pose2> poses;
  poses.reserve(graph.num_poses());
  for (int pose = 0; pose < graph.num_poses(); ++pose) poses.push_back(graph.WorldFromRobot(pose));
  return poses;
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_GRAPH_POSES_H_
