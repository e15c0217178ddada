#include "plumbline/apps/program/log_reader.h"

#include <utility>

#include "plumbline/apps/bags/open_bag.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/program/heap.h"
#include "plumbline/apps/program/implausible_readings.h"
#include "plumbline/apps/saved_maps/cartographer_state.h"
#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"
#include "plumbline/apps/saved_maps/slam_toolbox_map.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/front_end/motion_prediction.h"

namespace plumbline {
namespace {

void Warn(const std::string& path, const std::string& text, LogNotes* notes) {
  notes->lines.push_back("warning: " + Legible(path) + ": " + text);
}

// The graph mounts all scans alike, which makes nonsense of a second laser on the robot.
void WarnOfOtherMountings(const std::string& path, const LaserMounting& mounting, LogNotes* notes) {
  const std::string disagreement = mounting.Disagreement();
  if (disagreement.empty()) return;
  Warn(path,
       disagreement +
           "; all are mounted at the median. Are there two lasers, or the poses of another mapper?",
       notes);
}

Status ReadCarmen(const std::string& path, const LogReadOptions& options, LogNotes* notes,
                  SlamGraph* graph) {
  CarmenReadOptions read_options;
  read_options.max_bytes = options.max_bytes;
  CarmenLog log;
  PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(path, read_options, &log));
  log.sweep_time_s = options.sweep_time_s.value_or(0.0);
  for (const CarmenIssue& issue : log.issues) {
    notes->lines.push_back("skipped " + Legible(issue.message));
  }
  WarnOfOtherMountings(path, EstimateLaserMounting(log), notes);
  notes->counts = {log.num_issues, log.num_out_of_order};
  const Status built = BuildGraph(
      std::move(log), options.max_scans, [] { GiveFreedMemoryBack(); }, graph);
  return built.ok() ? built : Status::InvalidArgument(path + ": " + built.message());
}

Status ReadRosLog(const std::string& path, const LogReadOptions& options, LogNotes* notes,
                  SlamGraph* graph) {
  BagReadOptions read_options = options.bag;
  read_options.max_bytes = options.max_bytes;
  RosRecording recording;
  PLUMBLINE_RETURN_IF_ERROR(ReadBag(path, read_options, &recording));
  if (!recording.omission.empty()) Warn(path, recording.omission, notes);
  RosGraphOptions graph_options;
  graph_options.sweep_time_s = options.sweep_time_s;
  RosGraphNotes ros_notes;
  PLUMBLINE_RETURN_IF_ERROR(
      BuildGraph(recording, graph_options, options.max_scans, &ros_notes, graph));
  for (const std::string& scan : ros_notes.skipped_scans) {
    notes->lines.push_back("skipped " + Legible(scan));
  }
  for (const std::string& warning : ros_notes.warnings) {
    notes->lines.push_back("warning: " + Legible(warning));
  }
  notes->counts = {ros_notes.num_skipped_scans, ros_notes.num_out_of_order};
  return Status::Ok();
}

Status ReadSlamToolbox(const std::string& path, double max_bytes, SlamGraph* graph) {
  SlamToolboxMap map;
  int num_restarts = 0;
  PLUMBLINE_RETURN_IF_ERROR(ReadSlamToolboxMap(path, max_bytes, &map));
  return BuildGraph(map, graph, &num_restarts);
}

Status ReadAnyLog(const std::string& path, const LogReadOptions& options, LogNotes* notes,
                  SlamGraph* graph) {
  if (IsSlamToolboxMap(path)) return ReadSlamToolbox(path, options.max_bytes, graph);
  if (IsBag(path)) return ReadRosLog(path, options, notes, graph);
  return ReadCarmen(path, options, notes, graph);
}

}  // namespace

std::vector<std::string> LogFiles(const std::string& path) {
  if (IsSlamToolboxMap(path)) return SlamToolboxFiles(path);
  std::vector<std::string> files;
  return FilesOfLog(path, &files).ok() ? files : std::vector<std::string>{path};
}

Status ReadLog(const std::string& path, const LogReadOptions& options, LogNotes* notes,
               SlamGraph* graph) {
  *notes = LogNotes();
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  if (IsCartographerState(path)) {
    return Status::InvalidArgument(
        path + ": a map that Cartographer has saved, and no log; plumbline_slam refines it");
  }
  SlamGraph result;
  PLUMBLINE_RETURN_IF_ERROR(ReadAnyLog(path, options, notes, &result));
  if (result.num_returns() == 0) {
    return Status::InvalidArgument(path + ": no scan has a return within the laser's range");
  }
  if (!LacksOdometry(result)) {
    // No error: it may be the odometry that is mirrored.
    const Status mirrored = CheckScansAreNotMirrored(result, result.initial_poses(), std::nullopt);
    if (!mirrored.ok()) Warn(path, mirrored.message(), notes);
  }
  for (const std::string& fault : ImplausibleReadings(result)) Warn(path, fault, notes);
  *graph = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
