#ifndef PLUMBLINE_APPS_READERS_LOG_FILES_H_
#define PLUMBLINE_APPS_READERS_LOG_FILES_H_

#include <optional>
#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

/// Logs and maps in files, as the programs read and write them: the library plumbline::io.
namespace plumbline::io {

/// How a log is read.
struct ReadOptions {
  int max_scans = 0;       ///< the first ones are read; 0: all
  std::string scan_topic;  ///< of a bag; empty: the only laser in it
  /// Of a bag; "/tf": the transforms; empty: the only nav_msgs/Odometry, or the transforms.
  std::string odom_topic;
  /// From the first beam of a sweep to the last [s]; none: what a bag says, 0 for other logs.
  std::optional<double> sweep_time_s;
};

/// A log or a saved map, as it was read.
struct Log {
  /// NotFound, InvalidArgument or DataLoss, naming file, line and field; the graph is empty then.
  Status status;
  SlamGraph graph;                    ///< a pose per scan, placed by odometry or as in the file
  std::vector<std::string> warnings;  ///< doubts about the input, and skipped records
};

/// Reads a log in the format of CARMEN (plain or .gz), or a bag of ROS 1 or ROS 2 (file or folder).
Log ReadLog(const std::string& path, const ReadOptions& options = ReadOptions());

/// Reads a pose graph with its scans, if it has any: g2o or TORO (plain or .gz), a state of
/// Cartographer (.pbstream), or a map of slam_toolbox (.posegraph).
Log ReadPoseGraph(const std::string& path);

/// Writes poses with the times of the graph, one line `t x y z qx qy qz qw` each [s, m], as the TUM
/// RGB-D benchmark has it. poses: world_from_robot, one per pose of the graph.
Status WriteTrajectory(const std::string& path, const SlamGraph& graph,
                       const std::vector<Pose2>& poses);

/// Writes all map points as a binary PLY file: x y z [m], z = 0, and the id of their scan.
Status WritePoints(const std::string& path, const SlamGraph& graph, const MapState& map);

/// Writes an occupancy grid for the map servers of ROS: STEM.pgm and STEM.yaml.
Status WriteGrid(const std::string& stem, const SlamGraph& graph, const MapState& map,
                 double resolution_m = 0.05);

/// Writes poses, edges and scans as a g2o file, which ReadPoseGraph and the programs take.
Status WritePoseGraph(const std::string& path, const SlamGraph& graph,
                      const std::vector<Pose2>& poses);

// All writers write a file whole or leave the old one: InvalidArgument on poses or points that do
// not fit the graph, Unavailable if a file cannot be written.

}  // namespace plumbline::io

#endif  // PLUMBLINE_APPS_READERS_LOG_FILES_H_
