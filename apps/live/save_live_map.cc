#include "plumbline/apps/live/save_live_map.h"

#include <fcntl.h>
#include <stdio.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/readers/pose_graph_input.h"
#include "plumbline/apps/readers/pose_graph_log.h"
#include "plumbline/apps/report/run_summary.h"
#include "plumbline/apps/report/stage.h"
#include "plumbline/apps/run/map_run.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;

// A folder that is there must be empty or hold an earlier map and nothing else.
Status CheckTarget(const std::string& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return Status::Ok();
  if (!fs::is_directory(folder, error)) {
    return Status::InvalidArgument("'" + folder + "' is no folder");
  }
  const std::vector<std::string> results = ResultsIn(folder);
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto is_entry = [&](const std::string& file) {
      return fs::path(file).filename() == entry->path().filename();
    };
    if (std::any_of(results.begin(), results.end(), is_entry)) continue;
    return Status::InvalidArgument(
        "'" + folder + "' holds other files than a map: " + entry->path().filename().string());
  }
  return error ? WriteError("read the folder", folder, error.value()) : Status::Ok();
}

// Puts a complete folder in the place of another, which may be there.
Status PutInPlace(const OutputFolder& complete, const std::string& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) {
    fs::rename(complete.path(), folder, error);
    return error ? WriteError("make the folder", folder, error.value()) : Status::Ok();
  }
  if (renameat2(AT_FDCWD, complete.path().c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) !=
      0) {
    return WriteError("replace the folder", folder, errno);
  }
  PLUMBLINE_RETURN_IF_ERROR(complete.RemoveOldResults());  // of the earlier map
  fs::remove(complete.path(), error);
  return error ? WriteError("remove", complete.path(), error.value()) : Status::Ok();
}

// The odometry's map is shown if the scans have odometry, and one alone.
std::optional<Stage> OdometryStage(const MappedDrive& drive, ThreadPool* pool) {
  if (drive.continues_map) return std::nullopt;
  const LogMapping& mapping = drive.mapping;
  const OdometryNoiseReport& noise = mapping.report.seeding.odometry_noise;
  if (noise.is_prediction && noise.gross_translation_scale != 0.0 &&
      noise.given_poses.position_m == 0.0) {
    return std::nullopt;
  }
  return MeasureStage("odometry", mapping.graph, {mapping.graph.initial_poses(), {}}, nullptr,
                      pool);
}

Status WriteFiles(const MapLogOptions& options, double resolution_m, const OutputFolder& output,
                  MappedDrive* drive) {
  LogMapping* mapping = &drive->mapping;
  RunOutputOptions outputs;
  outputs.map_resolution_m = resolution_m;
  outputs.save_map = true;
  RunSummary summary;
  summary.log = "live drive";
  summary.num_scans = static_cast<std::size_t>(mapping->graph.num_scans());
  summary.num_returns = mapping->graph.num_returns();
  ThreadPool pool(options.solver.num_threads);
  const std::optional<Stage> odometry = OdometryStage(*drive, &pool);
  MapRun run(options, outputs, output, nullptr, std::move(summary), &pool, mapping);
  // The start is drawn as the state, as before the estimation.
  MapState start{mapping->start_poses, {}};
  std::swap(mapping->state, start);
  PLUMBLINE_RETURN_IF_ERROR(run.RecordStart(odometry ? &*odometry : nullptr));
  std::swap(mapping->state, start);
  PLUMBLINE_RETURN_IF_ERROR(run.WriteMap());
  return run.WriteReport("");
}

}  // namespace

Status SaveLiveMap(const MapLogOptions& options, double resolution_m, const std::string& folder,
                   MappedDrive drive) {
  const fs::path given = fs::path(folder).lexically_normal();
  const std::string target = (given.has_filename() ? given : given.parent_path()).string();
  PLUMBLINE_RETURN_IF_ERROR(CheckTarget(target));
  OutputFolder output(target + ".saving");
  PLUMBLINE_RETURN_IF_ERROR(output.Make());
  PLUMBLINE_RETURN_IF_ERROR(output.RemoveOldResults());
  Status status = WriteFiles(options, resolution_m, output, &drive);
  if (status.ok()) status = PutInPlace(output, target);
  if (status.ok()) return status;
  // Removes the incomplete folder.
  std::error_code ignored;
  if (output.RemoveOldResults().ok()) fs::remove(output.path(), ignored);
  return status;
}

Status ReadSavedMap(const std::string& path, bool is_fixed, SlamGraph* map) {
  std::error_code ignored;
  if (fs::exists(path, ignored) && !IsPoseGraph(path)) {
    return Status::InvalidArgument(path + ": no pose graph with scans; save_map writes map.g2o");
  }
  PoseGraphInput input;
  PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraph(path, 0.0, &input));
  SlamGraph graph;
  const Status made = LogOfPoseGraph(input.graph, 0, &graph);
  if (!made.ok()) return Status::InvalidArgument(path + ": " + made.message());
  for (int pose = 0; is_fixed && pose < graph.num_poses(); ++pose) graph.FixPose(pose);
  PLUMBLINE_RETURN_IF_ERROR(graph.status());
  *map = std::move(graph);
  return Status::Ok();
}

}  // namespace plumbline
