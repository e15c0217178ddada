#include "plumbline/apps/convert/convert.h"

#include <algorithm>
#include <utility>

#include "plumbline/apps/convert/replace_poses.h"
#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/io/pcd_writer.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/apps/io/pose_graph_writer.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/apps/program/log_flags.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/core/sweep_motion.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/sweep_order.h"

namespace plumbline {
namespace {

bool IsPoseGraph(const ConversionTarget& target) {
  return target.format == ConversionFormat::kG2o || target.format == ConversionFormat::kToro;
}

Status ReadInput(const ConvertOptions& options, PoseGraphFile* file, LogCounts* counts) {
  if (IsPoseGraphFile(options.input)) {
    if (SweepTimeFromFlags()) {
      return Status::InvalidArgument("--sweep_time_s goes with a log, but " + options.input +
                                     " is a pose graph");
    }
    return ReadPoseGraphFile(options.input, file);
  }
  LogNotes notes;
  PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(options.input, 0, &notes, &file->graph));
  *counts = notes.counts;
  if (std::none_of(options.targets.begin(), options.targets.end(), IsPoseGraph)) {
    return Status::Ok();
  }
  // Now, so that the scans keep the poses of the odometry, whatever a trajectory says.
  const Status status = MakePoseGraphFile(std::move(file->graph), MotionOptions(), file);
  return status.ok() ? status : Status::InvalidArgument(options.input + ": " + status.message());
}

// In which order lasers that turn measured the beams, and the returns where they belong by that.
void PlaceSweeps(SlamGraph* graph, MapState* state, ConversionReport* report) {
  const SolverOptions solver;
  ThreadPool pool(solver.num_threads);
  report->sweep_order = FindSweepOrder(SeedingOptions(), solver, *graph, &pool);
  *graph = graph->Corrected(TakeOutSweepMotion(*graph, *report->sweep_order, state->poses));
  state->points = graph->MeasuredMap(state->poses);
}

Status Write(const ConversionTarget& target, const PoseGraphFile& file, const MapState& state,
             double map_resolution_m) {
  switch (target.format) {
    case ConversionFormat::kTum:
      return WriteTumTrajectory(target.path, TrajectoryOf(file.graph, state));
    case ConversionFormat::kG2o:
      return WritePoseGraphFile(target.path, PoseGraphFormat::kG2o, file, state.poses);
    case ConversionFormat::kToro:
      return WritePoseGraphFile(target.path, PoseGraphFormat::kToro, file, state.poses);
    case ConversionFormat::kPly:
      return WritePointsPly(target.path, file.graph, state);
    case ConversionFormat::kPcd:
      return WritePointsPcd(target.path, file.graph, state);
    case ConversionFormat::kRosMap:
      break;
  }
  return WriteRobotMap(target.MapStem(), file.graph, state, map_resolution_m);
}

}  // namespace

bool ConvertOptions::Check(std::string* error) const {
  OccupancyGridOptions grid;
  grid.resolution_m = map_resolution_m;
  return grid.Check(error);
}

Status Convert(const ConvertOptions& options, ConversionReport* report) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("ROS map: " + error);
  ConversionReport result;
  PoseGraphFile file;
  PLUMBLINE_RETURN_IF_ERROR(ReadInput(options, &file, &result.counts));
  MapState state = file.graph.InitialState();
  if (!options.trajectory.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(ReplacePoses(options.trajectory, file.graph, &state));
  }
  for (const ConversionTarget& target : options.targets) {
    if (target.NeedsReturns() && file.graph.num_returns() == 0) {
      return Status::InvalidArgument(options.input + ": there are no returns of a laser for '" +
                                     target.path + "'");
    }
    if (target.format == ConversionFormat::kRosMap) {
      PLUMBLINE_RETURN_IF_ERROR(
          CheckRobotMap(options.input, file.graph, state, options.map_resolution_m));
    }
    result.left_out.push_back(LeftOut(target.format, file.graph));
  }
  result.num_poses = file.graph.num_poses();
  result.num_edges = file.graph.odometry().size() + file.graph.relative_poses().size();
  result.num_scans = file.graph.num_scans();
  result.num_returns = file.graph.num_returns();
  const bool shows_returns = std::any_of(options.targets.begin(), options.targets.end(),
                                         [](const auto& target) { return target.NeedsReturns(); });
  if (shows_returns && HasSweeps(file.graph)) PlaceSweeps(&file.graph, &state, &result);
  EndIfStoppedWhileWriting();
  for (const ConversionTarget& target : options.targets) {
    PLUMBLINE_RETURN_IF_ERROR(Write(target, file, state, options.map_resolution_m));
  }
  *report = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
