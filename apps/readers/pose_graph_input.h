#ifndef PLUMBLINE_APPS_READERS_POSE_GRAPH_INPUT_H_
#define PLUMBLINE_APPS_READERS_POSE_GRAPH_INPUT_H_

#include <functional>
#include <string>
#include <vector>

#include "plumbline/apps/io/warning.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A pose graph that another system has saved, whatever its format.
struct PoseGraphInput {
  std::string format;  ///< also the extension of its files
  SlamGraph graph;     ///< at the given poses
  /// The first poses of the graph are the robot's; others are frames of the other system, without
  /// scans.
  int num_robot_poses = 0;
  std::vector<long long> names;  ///< of the poses, in the file; empty: their ids in the graph
  /// Writes the same file with other poses, as MapState::poses.
  std::function<Status(const std::string& path, const std::vector<double>& poses)> write;
  std::string note;  ///< lines for people; may be empty
  std::vector<Warning> warnings;
};

/// Tells by its content whether a file is a pose graph, readable or not, and no log.
bool IsPoseGraph(const std::string& path);

/// Reads it. Fails like the reader of the format. Replaces *input on success only.
Status ReadPoseGraph(const std::string& path, double max_bytes, PoseGraphInput* input);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_READERS_POSE_GRAPH_INPUT_H_
