#include "plumbline/apps/readers/log_files.h"

#include <utility>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/io/pose_graph_writer.h"
#include "plumbline/apps/io/ros_map.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/readers/log_reader.h"
#include "plumbline/apps/readers/pose_graph_input.h"
#include "plumbline/core/catch_exceptions.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/solver_input.h"

namespace plumbline::io {
namespace {

void AddWarnings(const std::vector<Warning>& warnings, std::vector<std::string>* texts) {
  for (const Warning& warning : warnings) texts->push_back(warning.message);
}

Status CheckPoses(const SlamGraph& graph, const std::vector<Pose2>& poses) {
  return CheckStateSize(graph, {PoseArray(poses), {}}, false);
}

}  // namespace

Log ReadLog(const std::string& path, const ReadOptions& options) {
  Log log;
  log.status = CatchExceptions([&] {
    LogReadOptions of_reader;
    of_reader.max_scans = options.max_scans;
    of_reader.bag.scan_topic = options.scan_topic;
    of_reader.bag.odom_topic = options.odom_topic;
    of_reader.sweep_time_s = options.sweep_time_s;
    LogNotes notes;
    Status status = plumbline::ReadLog(path, of_reader, &notes, &log.graph);
    log.warnings = std::move(notes.skipped);
    AddWarnings(notes.warnings, &log.warnings);
    return status;
  });
  return log;
}

Log ReadPoseGraph(const std::string& path) {
  Log log;
  log.status = CatchExceptions([&] {
    PoseGraphInput input;
    PLUMBLINE_RETURN_IF_ERROR(plumbline::ReadPoseGraph(path, 0.0, &input));
    log.graph = std::move(input.graph);
    AddWarnings(input.warnings, &log.warnings);
    return Status::Ok();
  });
  return log;
}

Status WriteTrajectory(const std::string& path, const SlamGraph& graph,
                       const std::vector<Pose2>& poses) {
  return CatchExceptions([&] {
    PLUMBLINE_RETURN_IF_ERROR(CheckPoses(graph, poses));
    return WriteTumTrajectory(path, TrajectoryOf(graph, {PoseArray(poses), {}}));
  });
}

Status WritePoints(const std::string& path, const SlamGraph& graph, const MapState& map) {
  return CatchExceptions([&] {
    PLUMBLINE_RETURN_IF_ERROR(CheckStateSize(graph, map));
    return WritePointsPly(path, graph, map);
  });
}

Status WriteGrid(const std::string& stem, const SlamGraph& graph, const MapState& map,
                 double resolution_m) {
  return CatchExceptions([&] {
    PLUMBLINE_RETURN_IF_ERROR(CheckStateSize(graph, map));
    OccupancyGridOptions options;
    options.resolution_m = resolution_m;
    OccupancyGrid grid;
    PLUMBLINE_RETURN_IF_ERROR(BuildOccupancyGrid(graph, map, options, &grid));
    return WriteRosMap(stem, grid);
  });
}

Status WritePoseGraph(const std::string& path, const SlamGraph& graph,
                      const std::vector<Pose2>& poses) {
  return CatchExceptions([&] {
    PLUMBLINE_RETURN_IF_ERROR(CheckPoses(graph, poses));
    PoseGraphFile file;
    PLUMBLINE_RETURN_IF_ERROR(MakePoseGraphFile(graph, MotionOptions(), &file));
    return WritePoseGraphFile(path, PoseGraphFormat::kG2o, file, PoseArray(poses));
  });
}

}  // namespace plumbline::io
