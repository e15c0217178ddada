#include "plumbline/apps/readers/pose_graph_input.h"

#include <iomanip>
#include <memory>
#include <sstream>
#include <utility>

#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/apps/io/pose_graph_writer.h"
#include "plumbline/apps/readers/implausible_readings.h"
#include "plumbline/apps/saved_maps/cartographer_graph.h"
#include "plumbline/apps/saved_maps/cartographer_state.h"
#include "plumbline/apps/saved_maps/cartographer_writer.h"
#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"
#include "plumbline/apps/saved_maps/slam_toolbox_map.h"
#include "plumbline/apps/saved_maps/slam_toolbox_writer.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// g2o or TORO.
Status ReadTextGraph(const std::string& path, double max_bytes, PoseGraphInput* input) {
  const auto file = std::make_shared<PoseGraphFile>();
  PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraphFile(path, file.get(), max_bytes));
  input->format = ToString(file->format);
  input->graph = std::move(file->graph);
  input->names = file->vertex_ids;
  input->num_robot_poses = input->graph.num_poses();
  input->write = [file](const std::string& to, const std::vector<double>& poses) {
    return WritePoseGraphFile(to, file->format, *file, poses);
  };
  return Status::Ok();
}

std::string NoteText(const CartographerState& state, const CartographerGraphNotes& notes) {
  std::ostringstream text;
  text << "  " << state.nodes.size() << " nodes, " << state.submaps.size() << " submaps; "
       << "matches are off by " << std::fixed << std::setprecision(1) << 1e3 * notes.sigma_m
       << " mm and " << RadToDeg(notes.sigma_rad) << " deg (sigma); " << notes.num_contradicted
       << " of " << state.constraints.size()
       << " are off by more than three sigmas, and count for less\n";
  return text.str();
}

Status ReadCartographerGraph(const std::string& path, double max_bytes, PoseGraphInput* input) {
  CartographerState state;
  CartographerGraphNotes notes;
  PLUMBLINE_RETURN_IF_ERROR(ReadCartographerState(path, &state, max_bytes));
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(state, path, &input->graph, &notes));
  input->format = "pbstream";
  input->num_robot_poses = static_cast<int>(state.nodes.size());
  input->note = NoteText(state, notes);
  for (const int trajectory : notes.frozen_trajectories) {
    input->warnings.push_back(
        {"frozen_trajectory", path + ": trajectory " + std::to_string(trajectory) +
                                  " has no constraints within its submaps, as if it had been "
                                  "loaded frozen: it stays where it is"});
  }
  if (state.has_landmarks) {
    input->warnings.push_back(
        {"landmarks_unused", path + ": landmarks are neither used nor moved"});
  }
  const auto content = std::make_shared<const std::string>(std::move(state.content));
  input->write = [content](const std::string& to, const std::vector<double>& poses) {
    return WriteCartographerState(to, *content, poses);
  };
  return Status::Ok();
}

Status ReadSlamToolboxGraph(const std::string& path, double max_bytes, PoseGraphInput* input) {
  const auto map = std::make_shared<SlamToolboxMap>();
  int num_restarts = 0;
  PLUMBLINE_RETURN_IF_ERROR(ReadSlamToolboxMap(path, max_bytes, map.get()));
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(*map, &input->graph, &num_restarts));
  input->format = "posegraph";
  input->num_robot_poses = input->graph.num_poses();
  if (num_restarts > 0) {
    input->note = "  The odometry starts anew " + std::to_string(num_restarts) +
                  (num_restarts == 1 ? " time\n" : " times\n");
  }
  input->write = [map](const std::string& to, const std::vector<double>& poses) {
    return WriteSlamToolboxMap(to, *map, poses);
  };
  return Status::Ok();
}

}  // namespace

bool IsPoseGraph(const std::string& path) {
  return IsCartographerState(path) || IsSlamToolboxMap(path) || IsPoseGraphFile(path);
}

Status ReadPoseGraph(const std::string& path, double max_bytes, PoseGraphInput* input) {
  PoseGraphInput result;
  if (IsCartographerState(path)) {
    PLUMBLINE_RETURN_IF_ERROR(ReadCartographerGraph(path, max_bytes, &result));
  } else if (IsSlamToolboxMap(path)) {
    PLUMBLINE_RETURN_IF_ERROR(ReadSlamToolboxGraph(path, max_bytes, &result));
  } else {
    PLUMBLINE_RETURN_IF_ERROR(ReadTextGraph(path, max_bytes, &result));
  }
  for (const std::string& fault : ImplausibleReadings(result.graph)) {
    result.warnings.push_back({"implausible_ranges", path + ": " + fault});
  }
  *input = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
