#include "plumbline/apps/run/run_outputs.h"

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/io/pcd_writer.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/io/pose_graph_writer.h"
#include "plumbline/apps/io/return_records.h"
#include "plumbline/apps/io/ros_map.h"
#include "plumbline/apps/pictures/before_after_picture.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/pictures/overlay_pictures.h"
#include "plumbline/apps/readers/implausible_readings.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

WriteTask BeforeAfterTask(const std::string& path, const RefinedMap& map, int side_px) {
  BeforeAfterOptions options;
  options.before_title = "Before: " + map.before_title;
  options.after_title = "After: refined";
  options.max_side_px = std::min(side_px, BeforeAfterOptions::kLargestSidePx);
  return [=](int writer, OwnTask* rest) {
    const auto picture = std::make_shared<BeforeAfterPicture>();
    *rest = [=] { return picture->Draw(path); };
    return picture->Gather(*map.graph, *map.state, *map.poses_before, options, writer);
  };
}

// A robot can drive with a coarse map, but not without one.
WriteTask RobotMapTask(const std::string& stem, const RefinedMap& map,
                       const RunOutputOptions& options) {
  return [=](int writer, OwnTask* rest) {
    const auto grid = std::make_shared<OccupancyGrid>();
    PLUMBLINE_RETURN_IF_ERROR(
        GatherOccupancyGrid(*map.graph, *map.state, options.GridOptions(), writer, grid.get()));
    *rest = [=] { return WriteRosMap(stem, *grid); };
    if (grid->resolution_m > options.map_resolution_m && map.map_warning != nullptr) {
      std::ostringstream warning;
      warning << "the map, " << grid->width * grid->resolution_m << " m x "
              << grid->height * grid->resolution_m << " m, is too large for cells of "
              << options.map_resolution_m << " m (" << options.map_max_cells
              << " at most): those of map.pgm are " << grid->resolution_m << " m";
      *map.map_warning = warning.str();
    }
    return Status::Ok();
  };
}

using StorePoints = Status (*)(const std::string& path, const SlamGraph& graph,
                               const MapState& state, ReturnRecords* file);

// The disk takes its time. Processes that have to wait for it together do so with the last tasks.
void AddPointsTasks(StorePoints store, const std::string& path, const RefinedMap& map,
                    std::vector<WriteTask>* tasks, std::vector<WriteTask>* last) {
  const auto file = std::make_shared<ReturnRecords>();
  const OwnTask commit = [file] { return file->Commit(); };
  const bool is_alone = map.graph->peers() == nullptr;
  tasks->push_back([=](int, OwnTask* rest) {
    if (is_alone) *rest = commit;
    return store(path, *map.graph, *map.state, file.get());
  });
  if (!is_alone) last->push_back(Together(commit));
}

// Pose graphs hang together. Where no odometry leads from a pose to the next, they lie as the map
// has them, give or take a metre and a radian.
std::vector<RelativePoseConstraint> EdgesBetweenDrives(const SlamGraph& graph,
                                                       const std::vector<double>& poses) {
  std::vector<bool> is_reached(graph.num_poses(), false);
  for (const OdometryConstraint& step : graph.odometry()) is_reached[step.to] = true;
  std::vector<RelativePoseConstraint> edges;
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    if (is_reached[pose]) continue;
    RelativePoseConstraint& edge = edges.emplace_back();
    edge.from = pose - 1;
    edge.to = pose;
    edge.from_from_to = Between(Pose2(&poses[3 * (pose - 1)]), Pose2(&poses[3 * pose]));
    edge.covariance = Eigen::Matrix3d::Identity();
  }
  return edges;
}

}  // namespace

bool RunOutputOptions::Check(std::string* error) const {
  MapPictureOptions picture;
  picture.max_side_px = picture_side_px;
  return picture.Check(error) && GridOptions().Check(error);
}

void RunOutputOptions::LimitGrid(double bytes) {
  map_max_cells = std::min(map_max_cells, bytes / OccupancyGridOptions::kBytesPerCell);
}

OccupancyGridOptions RunOutputOptions::GridOptions() const {
  OccupancyGridOptions grid;
  grid.resolution_m = map_resolution_m;
  grid.max_cells = map_max_cells;
  grid.coarsen_to_fit = true;
  return grid;
}

Status CheckRobotMap(const std::string& input, const SlamGraph& graph, const MapState& state,
                     double resolution_m) {
  OccupancyGridOptions options;
  options.resolution_m = resolution_m;
  Status status = CheckGridSize(graph, state, options);
  if (status.ok()) return status;
  std::vector<std::string> causes = ImplausibleReadings(graph);
  causes.push_back(ImplausibleOdometry(graph));
  std::string text = input + ": " + status.message();
  for (const std::string& cause : causes) {
    if (!cause.empty()) text += "; likely cause: " + cause;
  }
  return Status::InvalidArgument(text);
}

Status WriteRobotMap(const std::string& stem, const SlamGraph& graph, const MapState& state,
                     double resolution_m) {
  OccupancyGridOptions options;
  options.resolution_m = resolution_m;
  OccupancyGrid grid;
  PLUMBLINE_RETURN_IF_ERROR(GatherOccupancyGrid(graph, state, options, 0, &grid));
  return SpeaksForAll(graph.peers()) ? WriteRosMap(stem, grid) : Status::Ok();
}

Status WriteSavedMap(const std::string& path, const SlamGraph& graph,
                     const std::vector<double>& poses, const MotionOptions& motion) {
  return WritePoseGraph(path, graph, motion, EdgesBetweenDrives(graph, poses), poses);
}

RefinedMap RefinedMapOf(const LogMapping& mapping) {
  RefinedMap map;
  map.graph = &mapping.graph;
  map.state = &mapping.state;
  map.poses_before = &mapping.start_poses;
  map.before_title = "seed";
  map.consistency = &mapping.report.consistency;
  return map;
}

WriteTask DrawTask(const std::string& path, const SlamGraph& graph, const MapState& state,
                   MapPictureOptions picture, int side_px, MapArea* area) {
  picture.max_side_px = side_px;
  return [=, &graph, &state](int writer, OwnTask* rest) {
    const auto gathered = std::make_shared<MapPicture>();
    PLUMBLINE_RETURN_IF_ERROR(gathered->Gather(graph, state, picture, writer));
    if (area != nullptr) *area = gathered->area();
    *rest = [=] { return gathered->Draw(path); };
    return Status::Ok();
  };
}

std::vector<WriteTask> MapWriteTasks(const RefinedMap& map, const RunOutputOptions& options,
                                     const OutputFolder& output) {
  const SlamGraph& graph = *map.graph;
  const MapState& state = *map.state;
  const int side_px = options.picture_side_px;
  std::vector<WriteTask> tasks, last;
  AddPointsTasks(&StorePointsPly, output.File("points.ply"), map, &tasks, &last);
  AddPointsTasks(&StorePointsPcd, output.File("points.pcd"), map, &tasks, &last);
  if (map.consistency != nullptr) {
    tasks.push_back(DrawTask(output.File("conflicts.png"), graph, state,
                             ShowConflicts(*map.consistency), side_px));
  }
  tasks.push_back(BeforeAfterTask(output.File("before_after.png"), map, side_px));
  MapPictureOptions refined;
  refined.title = "Refined";
  tasks.push_back(
      DrawTask(output.File("map_refined.png"), graph, state, refined, side_px, map.picture_area));
  tasks.push_back(RobotMapTask(output.File("map"), map, options));
  tasks.insert(tasks.end(), last.begin(), last.end());
  return tasks;
}

std::string MapFilesText(bool with_conflicts) {
  return std::string(
             "  map_refined.png                                   picture of the refined map\n"
             "  before_after.png                                  the map before and after "
             "refinement\n") +
         (with_conflicts ? "  conflicts.png                                     where the refined "
                           "map contradicts itself\n"
                         : "") +
         "  map.pgm, map.yaml                                 occupancy grid for robots (ROS, "
         "Nav2)\n"
         "  points.ply, points.pcd                            every return, optimised\n";
}

}  // namespace plumbline
