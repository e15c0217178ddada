#include "plumbline/apps/readers/log_reader.h"

#include <algorithm>
#include <utility>

#include "plumbline/apps/bags/open_bag.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/heap.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/readers/implausible_readings.h"
#include "plumbline/apps/saved_maps/cartographer_state.h"
#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"
#include "plumbline/apps/saved_maps/slam_toolbox_map.h"
#include "plumbline/core/angle.h"
#include "plumbline/solvers/acceptance/mirrored_scans.h"
#include "plumbline/solvers/front_end/motion_prediction.h"

namespace plumbline {
namespace {

void Warn(const std::string& path, const std::string& id, const std::string& text,
          LogNotes* notes) {
  notes->warnings.push_back({id, path + ": " + text});
}

// The graph mounts all scans alike, which makes nonsense of a second laser on the robot.
void WarnOfOtherMountings(const std::string& path, const LaserMounting& mounting, LogNotes* notes) {
  const std::string disagreement = mounting.Disagreement();
  if (disagreement.empty()) return;
  Warn(path, "laser_mountings_differ",
       disagreement +
           "; all are mounted at the median. Are there two lasers, or the poses of another mapper?",
       notes);
}

// True if the scans of a graph match far better than the scans of another one around the turns of
// the odometry.
bool FitsTurnsBetter(const SlamGraph& graph, const SlamGraph& other) {
  constexpr double kFarBetter = 0.8;
  const std::optional<double> mismatch_m = TurnMismatch(graph, graph.initial_poses());
  const std::optional<double> other_m = TurnMismatch(other, other.initial_poses());
  return mismatch_m && other_m && *mismatch_m < kFarBetter * *other_m;
}

bool HasAssumedView(const CarmenScan& scan) {
  return scan.is_flaser && (scan.ranges.size() == 541 || scan.ranges.size() == 1081);
}

// Takes the fields of view that lasers of 541 and 1081 beams have, or 180 deg as for other FLASER
// records if the turns of the odometry say so.
Status BuildWithAssumedView(const std::string& path, CarmenLog log, int max_scans, LogNotes* notes,
                            SlamGraph* graph) {
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(log, max_scans, graph));
  for (CarmenScan& scan : log.scans) {
    if (!HasAssumedView(scan)) continue;
    const auto num_beams = static_cast<int>(scan.ranges.size());
    SetFlaserBearings(num_beams, kPi, &scan.first_bearing_rad, &scan.bearing_step_rad);
  }
  SlamGraph half_turn;
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(log, max_scans, &half_turn));
  const bool is_half_turn = !LacksOdometry(half_turn) && FitsTurnsBetter(half_turn, *graph);
  if (is_half_turn) *graph = std::move(half_turn);
  Warn(path, "assumed_field_of_view",
       std::string("FLASER records of 541 or 1081 beams do not say what these cover; ") +
           (is_half_turn ? "180 deg, by the turns of the odometry" : "270 deg, as usual") +
           " (--fov_deg states it)",
       notes);
  return Status::Ok();
}

Status ReadCarmen(const std::string& path, const LogReadOptions& options, LogNotes* notes,
                  SlamGraph* graph) {
  CarmenReadOptions read_options;
  read_options.max_bytes = options.max_bytes;
  read_options.flaser_fov_rad = options.flaser_fov_rad;
  CarmenLog log;
  PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(path, read_options, &log));
  log.sweep_time_s = options.sweep_time_s.value_or(0.0);
  for (const CarmenIssue& issue : log.issues) {
    notes->skipped.push_back("skipped " + issue.message);
  }
  if (log.num_issues > 0) {
    Warn(path, "skipped_records",
         std::to_string(log.num_issues) + " of " + std::to_string(log.num_records) +
             " records are skipped; the first one: " + log.issues.front().message,
         notes);
  }
  WarnOfOtherMountings(path, EstimateLaserMounting(log), notes);
  notes->counts = {log.num_issues, log.num_out_of_order};
  notes->no_return_level_m = log.no_return_level_m;
  for (CarmenScan& scan : log.scans) {
    TurnBeams(options.beam_direction, static_cast<int>(scan.ranges.size()), &scan.first_bearing_rad,
              &scan.bearing_step_rad);
  }
  const bool has_assumed_view =
      !options.flaser_fov_rad && std::any_of(log.scans.begin(), log.scans.end(), HasAssumedView);
  const Status built =
      has_assumed_view
          ? BuildWithAssumedView(path, std::move(log), options.max_scans, notes, graph)
          : BuildGraph(
                std::move(log), options.max_scans, [] { GiveFreedMemoryBack(); }, graph);
  return built.ok() ? built : Status::InvalidArgument(path + ": " + built.message());
}

Status ReadRosLog(const std::string& path, const LogReadOptions& options, LogNotes* notes,
                  SlamGraph* graph) {
  BagReadOptions read_options = options.bag;
  read_options.max_bytes = options.max_bytes;
  RosRecording recording;
  PLUMBLINE_RETURN_IF_ERROR(ReadBag(path, read_options, &recording));
  if (!recording.omission.empty()) {
    Warn(path, "interrupted_recording", recording.omission, notes);
  }
  RosGraphOptions graph_options;
  graph_options.sweep_time_s = options.sweep_time_s;
  graph_options.laser_frame = options.laser_frame;
  graph_options.clock = options.clock;
  graph_options.beam_direction = options.beam_direction;
  RosGraphNotes ros_notes;
  PLUMBLINE_RETURN_IF_ERROR(
      BuildGraph(recording, graph_options, options.max_scans, &ros_notes, graph));
  if (ros_notes.angles_contradict && !LacksOdometry(*graph)) {
    graph_options.angle_source = BeamAngleSource::kIncrement;
    RosGraphNotes other_notes;
    SlamGraph other;
    PLUMBLINE_RETURN_IF_ERROR(
        BuildGraph(recording, graph_options, options.max_scans, &other_notes, &other));
    if (FitsTurnsBetter(other, *graph)) {
      *graph = std::move(other);
      ros_notes = std::move(other_notes);
    }
  }
  for (const std::string& scan : ros_notes.skipped_scans) {
    notes->skipped.push_back("skipped " + scan);
  }
  notes->warnings.insert(notes->warnings.end(), ros_notes.warnings.begin(),
                         ros_notes.warnings.end());
  notes->counts = {ros_notes.num_skipped_scans, ros_notes.num_out_of_order};
  notes->no_return_level_m = ros_notes.no_return_level_m;
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
    if (!mirrored.ok()) {
      Warn(path, "mirrored_scans",
           mirrored.message() + " --beam_direction=reversed or =upside_down turns them round",
           notes);
    }
    const std::string odometry = ImplausibleOdometry(result);
    if (!odometry.empty()) Warn(path, "implausible_odometry", odometry, notes);
  }
  for (const std::string& fault : ImplausibleReadings(result)) {
    Warn(path, "implausible_ranges", fault, notes);
  }
  *graph = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
