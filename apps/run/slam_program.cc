#include "plumbline/apps/run/slam_program.h"

#include <gflags/gflags.h>

#include <iostream>
#include <string>
#include <utility>

#include "plumbline/apps/program/log_flags.h"
#include "plumbline/apps/program/log_info.h"
#include "plumbline/apps/program/log_list.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/readers/log_reader.h"
#include "plumbline/apps/readers/pose_graph_input.h"
#include "plumbline/apps/report/calibration_report.h"
#include "plumbline/apps/run/flags.h"
#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/pose_graph_run.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/apps/run/sessions_run.h"
#include "plumbline/core/over_peers.h"

DEFINE_string(
    log, "",
    "Log to map (CARMEN, or bag of ROS 1 or ROS 2, file or folder), or pose graph to refine (g2o, "
    "TORO, or a saved map: a state of Cartographer, .pbstream, or a map of slam_toolbox, "
    ".posegraph); text plain or .gz. Several, separated by commas, or @FILE with one per line, are "
    "sessions whose relative poses are unknown: those that show the same place become one map");
DEFINE_string(
    info, "",
    "File to describe instead of mapping it: topics or records, times, lasers, what a run "
    "would use, and its warnings");
DEFINE_string(output_dir, "",
              "Folder for the results; made if it is not there, and for one run at a time");
DEFINE_int32(max_scans, 0, "Use the first scans of a log only [scans]; 0: all of them");
DEFINE_string(
    fixed_map, "",
    "Finished map (a pose graph with scans, as --save_map writes it) to localise the logs "
    "in: its poses stay where they are");
DEFINE_bool(save_map, false,
            "Also write map.g2o, the refined poses with all scans: to give as one of several logs, "
            "or as --fixed_map");
DEFINE_bool(measure_rounds, false,
            "Also measure the energy after every round, the same one for all solvers: a plot in "
            "report.html, and summary.json");
DEFINE_int32(picture_side_px, plumbline::RunOutputOptions().picture_side_px,
             "Longer side of the pictures, at most [px]");
DEFINE_double(map_resolution_m, plumbline::RunOutputOptions().map_resolution_m,
              "Side of a cell of the occupancy grid, map.pgm [m]");
DEFINE_string(truth, "", "True trajectory (TUM) of a simulated log, to measure errors against");
DEFINE_string(calibrate, "",
              "Sensor parameters to estimate along with the map, separated by commas: mounting, "
              "range_bias, range_scale, odometry_scale");
DEFINE_string(hits, "", "True point of every return ('t beam x y'), to go with --truth");
DEFINE_string(
    max_memory, "0",
    "Where a run needs more than this by estimate, as 4GB or 500MB: make pictures and the "
    "occupancy grid coarser, or else refuse it; 0: no limit");

namespace plumbline {
namespace {

// Of the logs that the flags name. What is wrong with a list of them is found when it is read.
Status LogsFromFlags(std::vector<std::string>* logs) {
  const Status parsed = ParseLogList(FLAGS_log, logs);
  if (parsed.code() != StatusCode::kInvalidArgument) return Status::Ok();
  return Status::InvalidArgument("--log: " + parsed.message());
}

// Several sessions have no common odometry or truth, and each its own laser.
Status CheckFlagsOfSessions(const MapLogOptions& mapping) {
  for (const char* flag : {"truth", "calibrate"}) {
    const gflags::CommandLineFlagInfo info = gflags::GetCommandLineFlagInfoOrDie(flag);
    if (info.current_value == info.default_value) continue;
    return Status::InvalidArgument("--" + info.name +
                                   " goes with one log alone, not with several, and not with "
                                   "--fixed_map");
  }
  if (mapping.start != StartType::kSeed) {
    return Status::InvalidArgument(
        "--start: several logs, and those in a --fixed_map, start at the seed");
  }
  if (!mapping.solver.MovesPosesOnly()) return Status::Ok();
  return Status::InvalidArgument("--solver=" + std::string(ToString(mapping.solver.type)) +
                                 " looks at no returns, which tie logs to each other");
}

Status PrintInfo() {
  std::string text;
  Status status = DescribeInput(FLAGS_info, LogReadOptionsFromFlags(), &text);
  std::cout << text;
  return status;
}

Status RefinePoseGraphFile(const LogRunOptions& options) {
  for (const char* flag :
       {"start", "max_scans", "save_map", "truth", "calibrate", "sweep_time_s", "beam_direction"}) {
    const gflags::CommandLineFlagInfo info = gflags::GetCommandLineFlagInfoOrDie(flag);
    if (info.current_value == info.default_value) continue;
    return Status::InvalidArgument("--" + info.name + " goes with a log, but " + options.log +
                                   " is a pose graph");
  }
  return RunPoseGraph({options.log, options.output_dir, options.outputs, options.mapping.solver,
                       options.max_memory, options.peers, options.mapping.seeding});
}

}  // namespace

const std::vector<FileFlag>& SlamFiles() {
  static const std::vector<FileFlag> flags = {
      {"log", &FLAGS_log, FileUse::kInput, FilesOfLogList},
      {"info", &FLAGS_info, FileUse::kInput, LogFiles},
      {"fixed_map", &FLAGS_fixed_map, FileUse::kInput, LogFiles},
      {"truth", &FLAGS_truth, FileUse::kInput},
      {"hits", &FLAGS_hits, FileUse::kInput},
      {"output_dir", &FLAGS_output_dir, FileUse::kOutputFolder, ResultsIn}};
  return flags;
}

Status SlamOptionsFromFlags(LogRunOptions* options) {
  if (!FLAGS_info.empty()) return Status::Ok();  // the other flags have nothing to say
  if (FLAGS_log.empty()) return Status::InvalidArgument("--log is missing; see --help");
  std::vector<std::string> logs;
  PLUMBLINE_RETURN_IF_ERROR(LogsFromFlags(&logs));
  if (FLAGS_output_dir.empty()) {
    return Status::InvalidArgument("--output_dir is missing; see --help");
  }
  if (FLAGS_max_scans < 0) return Status::InvalidArgument("--max_scans must be >= 0");
  if (FLAGS_truth.empty() && !FLAGS_hits.empty()) {
    return Status::InvalidArgument("--hits needs --truth");
  }
  MapLogOptions& mapping = options->mapping;
  PLUMBLINE_RETURN_IF_ERROR(SolverOptionsFromFlags(&mapping.solver));
  mapping.solver.measure_rounds = FLAGS_measure_rounds;
  PLUMBLINE_RETURN_IF_ERROR(StartFromFlags(mapping.solver, &mapping.start));
  PLUMBLINE_RETURN_IF_ERROR(CheckNoFlagIsIgnored(mapping.solver, mapping.start));
  PLUMBLINE_RETURN_IF_ERROR(SeedingOptionsFromFlags(&mapping.seeding));
  const Status parsed = ParseCalibration(FLAGS_calibrate, &mapping.calibration);
  if (!parsed.ok()) return Status::InvalidArgument("--calibrate: " + parsed.message());
  if (mapping.calibration.IsOn() && mapping.solver.MovesPosesOnly()) {
    return Status::InvalidArgument(
        "--calibrate does not go with --solver=" + std::string(ToString(mapping.solver.type)) +
        ", which looks at no returns");
  }
  if (logs.size() > 1 || !FLAGS_fixed_map.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(CheckFlagsOfSessions(mapping));
  }
  const Status memory = ParseMemorySize(FLAGS_max_memory, &options->max_memory);
  if (!memory.ok()) return Status::InvalidArgument("--max_memory: " + memory.message());
  RunOutputOptions& outputs = options->outputs;
  outputs.picture_side_px = FLAGS_picture_side_px;
  outputs.map_resolution_m = FLAGS_map_resolution_m;
  outputs.save_map = FLAGS_save_map;
  if (options->max_memory > 0.0) outputs.LimitGrid(0.5 * options->max_memory);
  std::string error;
  if (!outputs.Check(&error)) return Status::InvalidArgument("results: " + error);
  options->log = FLAGS_log;
  options->output_dir = FLAGS_output_dir;
  options->max_scans = FLAGS_max_scans;
  options->truth = FLAGS_truth;
  options->hits = FLAGS_hits;
  return Status::Ok();
}

Status RunSlam(LogRunOptions options) {
  if (!FLAGS_info.empty()) return BySpeaker(options.peers, PrintInfo);
  EndIfStoppedWhile("reading " + options.log);
  std::vector<std::string> logs;
  PLUMBLINE_RETURN_IF_ERROR(ParseLogList(options.log, &logs));
  if (logs.size() > 1 || !FLAGS_fixed_map.empty()) {
    return RunSessions({std::move(logs), FLAGS_fixed_map, options.output_dir, options.max_scans,
                        options.mapping, options.outputs, options.max_memory, options.peers});
  }
  options.log = logs.front();
  return IsPoseGraph(options.log) ? RefinePoseGraphFile(options) : RunLog(options);
}

}  // namespace plumbline
