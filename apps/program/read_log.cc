#include "plumbline/apps/program/read_log.h"

#include <iostream>
#include <optional>
#include <utility>

#include "plumbline/apps/bags/bag_reader.h"
#include "plumbline/apps/bags/open_bag.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/program/implausible_readings.h"
#include "plumbline/apps/program/log_flags.h"
#include "plumbline/apps/saved_maps/cartographer_state.h"
#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"
#include "plumbline/apps/saved_maps/slam_toolbox_map.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/front_end/motion_prediction.h"

namespace plumbline {
namespace {

// The graph mounts all scans alike, which makes nonsense of a second laser on the robot.
void WarnOfOtherMountings(const std::string& path, const LaserMounting& mounting) {
  const std::string disagreement = mounting.Disagreement();
  if (disagreement.empty()) return;
  std::cerr << "warning: " << Legible(path) << ": " << disagreement
            << "; all are mounted at the median. Are there two lasers, or the poses of another "
               "mapper?\n";
}

Status ReadCarmen(const std::string& path, int max_scans, double max_bytes, LogCounts* counts,
                  SlamGraph* graph) {
  CarmenReadOptions options;
  options.max_bytes = max_bytes;
  CarmenLog log;
  PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(path, options, &log));
  log.sweep_time_s = SweepTimeFromFlags().value_or(0.0);
  for (const CarmenIssue& issue : log.issues) {
    std::cerr << "skipped " << Legible(issue.message) << '\n';
  }
  WarnOfOtherMountings(path, EstimateLaserMounting(log));
  *counts = {log.num_issues, log.num_out_of_order};
  const Status built = BuildGraph(log, max_scans, graph);
  return built.ok() ? built : Status::InvalidArgument(path + ": " + built.message());
}

Status ReadRosLog(const std::string& path, int max_scans, double max_bytes, LogCounts* counts,
                  SlamGraph* graph) {
  BagReadOptions read_options = BagReadOptionsFromFlags();
  read_options.max_bytes = max_bytes;
  RosRecording recording;
  PLUMBLINE_RETURN_IF_ERROR(ReadBag(path, read_options, &recording));
  RosGraphOptions options;
  options.sweep_time_s = SweepTimeFromFlags();
  RosGraphNotes notes;
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(recording, options, max_scans, &notes, graph));
  for (const std::string& scan : notes.skipped_scans) {
    std::cerr << "skipped " << Legible(scan) << '\n';
  }
  for (const std::string& warning : notes.warnings) {
    std::cerr << "warning: " << Legible(warning) << '\n';
  }
  *counts = {notes.num_skipped_scans, notes.num_out_of_order};
  return Status::Ok();
}

Status ReadSlamToolbox(const std::string& path, double max_bytes, SlamGraph* graph) {
  SlamToolboxMap map;
  int num_restarts = 0;
  PLUMBLINE_RETURN_IF_ERROR(ReadSlamToolboxMap(path, max_bytes, &map));
  return BuildGraph(map, graph, &num_restarts);
}

Status ReadAnyLog(const std::string& path, int max_scans, double max_bytes, LogCounts* counts,
                  SlamGraph* graph) {
  if (IsSlamToolboxMap(path)) return ReadSlamToolbox(path, max_bytes, graph);
  if (IsBag(path)) return ReadRosLog(path, max_scans, max_bytes, counts, graph);
  return ReadCarmen(path, max_scans, max_bytes, counts, graph);
}

}  // namespace

std::vector<std::string> LogFiles(const std::string& path) {
  if (IsSlamToolboxMap(path)) return SlamToolboxFiles(path);
  std::vector<std::string> files;
  return FilesOfLog(path, &files).ok() ? files : std::vector<std::string>{path};
}

Status ReadLogIntoGraph(const std::string& path, int max_scans, LogCounts* counts, SlamGraph* graph,
                        double max_bytes) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  if (IsCartographerState(path)) {
    return Status::InvalidArgument(
        path + ": a map that Cartographer has saved, and no log; plumbline_slam refines it");
  }
  SlamGraph result;
  LogCounts result_counts;
  PLUMBLINE_RETURN_IF_ERROR(ReadAnyLog(path, max_scans, max_bytes, &result_counts, &result));
  if (result.num_returns() == 0) {
    return Status::InvalidArgument(path + ": no scan has a return within the laser's range");
  }
  if (!LacksOdometry(result)) {
    // No error: it may be the odometry that is mirrored.
    const Status mirrored = CheckScansAreNotMirrored(result, result.initial_poses(), std::nullopt);
    if (!mirrored.ok()) {
      std::cerr << "warning: " << Legible(path) << ": " << mirrored.message() << '\n';
    }
  }
  for (const std::string& fault : ImplausibleReadings(result)) {
    std::cerr << "warning: " << Legible(path) << ": " << fault << '\n';
  }
  *counts = result_counts;
  *graph = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
