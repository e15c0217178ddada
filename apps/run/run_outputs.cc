#include "plumbline/apps/run/run_outputs.h"

#include <Eigen/Core>
#include <algorithm>
#include <sstream>
#include <utility>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/io/pcd_writer.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/io/pose_graph_writer.h"
#include "plumbline/apps/io/ros_map.h"
#include "plumbline/apps/pictures/before_after_picture.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/pictures/overlay_pictures.h"
#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

Status WriteRefinedPicture(const std::string& path, const RefinedMap& map, int max_side_px) {
  MapPictureOptions options;
  options.title = "Refined";
  options.max_side_px = max_side_px;
  return WriteMapPicture(path, *map.graph, *map.state, options, map.picture_area);
}

Status WriteBeforeAfter(const std::string& path, const RefinedMap& map, int max_side_px) {
  BeforeAfterOptions options;
  options.before_title = "Before: " + map.before_title;
  options.after_title = "After: refined";
  options.max_side_px = std::min(max_side_px, BeforeAfterOptions::kLargestSidePx);
  return WriteBeforeAfterPicture(path, *map.graph, *map.state, *map.poses_before, options);
}

Status WriteGrid(const std::string& stem, const SlamGraph& graph, const MapState& state,
                 const OccupancyGridOptions& options, OccupancyGrid* grid) {
  PLUMBLINE_RETURN_IF_ERROR(BuildOccupancyGrid(graph, state, options, grid));
  return SpeaksForAll(graph.peers()) ? WriteRosMap(stem, *grid) : Status::Ok();
}

// A robot can drive with a coarse map, but not without one.
Status WriteMapThatFits(const std::string& stem, const RefinedMap& map,
                        const RunOutputOptions& options) {
  OccupancyGrid grid;
  PLUMBLINE_RETURN_IF_ERROR(WriteGrid(stem, *map.graph, *map.state, options.GridOptions(), &grid));
  if (grid.resolution_m > options.map_resolution_m && map.map_warning != nullptr) {
    std::ostringstream warning;
    warning << "the map, " << grid.width * grid.resolution_m << " m x "
            << grid.height * grid.resolution_m << " m, is too large for cells of "
            << options.map_resolution_m << " m (" << options.map_max_cells
            << " at most): those of map.pgm are " << grid.resolution_m << " m";
    *map.map_warning = warning.str();
  }
  return Status::Ok();
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
  const Status status = CheckGridSize(graph, state, options);
  return status.ok() ? status : Status::InvalidArgument(input + ": " + status.message());
}

Status WriteRobotMap(const std::string& stem, const SlamGraph& graph, const MapState& state,
                     double resolution_m) {
  OccupancyGridOptions options;
  options.resolution_m = resolution_m;
  OccupancyGrid grid;
  return WriteGrid(stem, graph, state, options, &grid);
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

std::vector<WriteTask> MapWriteTasks(const RefinedMap& map, const RunOutputOptions& options,
                                     const OutputFolder& output) {
  const SlamGraph& graph = *map.graph;
  const MapState& state = *map.state;
  std::vector<WriteTask> tasks = {
      [=, &output] {
        return WriteBeforeAfter(output.File("before_after.png"), map, options.picture_side_px);
      },
      [=, &output] {
        return WriteRefinedPicture(output.File("map_refined.png"), map, options.picture_side_px);
      },
      [=, &output] { return WriteMapThatFits(output.File("map"), map, options); },
      [=, &graph, &state, &output] {
        return WritePointsPly(output.File("points.ply"), graph, state);
      },
      [=, &graph, &state, &output] {
        return WritePointsPcd(output.File("points.pcd"), graph, state);
      }};
  if (map.consistency != nullptr) {
    tasks.insert(tasks.begin(), [=, &graph, &state, &output] {
      return WriteConflictPicture(output.File("conflicts.png"), graph, state, *map.consistency,
                                  options.picture_side_px);
    });
  }
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

Status RunAll(const std::vector<WriteTask>& tasks, ThreadPool* pool, const Peers* peers) {
  if (peers != nullptr) {
    for (const WriteTask& task : tasks) PLUMBLINE_RETURN_IF_ERROR(FirstFailure(peers, task()));
    return Status::Ok();
  }
  std::vector<Status> results(tasks.size());
  pool->ForEachChunk(tasks.size(), 1, [&](std::size_t, std::size_t begin, std::size_t) {
    results[begin] = CatchExceptions(tasks[begin]);
  });
  for (const Status& result : results) PLUMBLINE_RETURN_IF_ERROR(result);
  return Status::Ok();
}

}  // namespace plumbline
