#include "plumbline/apps/run_outputs.h"

#include <algorithm>

#include "plumbline/apps/io/before_after_picture.h"
#include "plumbline/apps/io/map_picture.h"
#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/io/overlay_pictures.h"
#include "plumbline/apps/io/pcd_writer.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/io/ros_map.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

Status WriteRefinedPicture(const std::string& path, const RefinedMap& map, int max_side_px) {
  MapPictureOptions options;
  options.title = "Refined";
  options.max_side_px = max_side_px;
  return WriteMapPicture(path, *map.graph, options, map.picture_area);
}

Status WriteBeforeAfter(const std::string& path, const RefinedMap& map, int max_side_px) {
  BeforeAfterOptions options;
  options.before_title = "Before: " + map.before_title;
  options.after_title = "After: refined";
  options.max_side_px = std::min(max_side_px, BeforeAfterOptions::kLargestSidePx);
  return WriteBeforeAfterPicture(path, *map.graph, *map.poses_before, options);
}

}  // namespace

bool RunOutputOptions::Check(std::string* error) const {
  MapPictureOptions picture;
  picture.max_side_px = picture_side_px;
  OccupancyGridOptions grid;
  grid.resolution_m = map_resolution_m;
  return picture.Check(error) && grid.Check(error);
}

Status WriteRobotMap(const std::string& stem, const SlamGraph& graph, double resolution_m) {
  OccupancyGridOptions options;
  options.resolution_m = resolution_m;
  OccupancyGrid grid;
  PLUMBLINE_RETURN_IF_ERROR(BuildOccupancyGrid(graph, options, &grid));
  return WriteRosMap(stem, grid);
}

std::vector<WriteTask> MapWriteTasks(const RefinedMap& map, const RunOutputOptions& options,
                                     const OutputFolder& output) {
  const SlamGraph& graph = *map.graph;
  std::vector<WriteTask> tasks = {
      [=] {
        return WriteBeforeAfter(output.File("before_after.png"), map, options.picture_side_px);
      },
      [=] {
        return WriteRefinedPicture(output.File("map_refined.png"), map, options.picture_side_px);
      },
      [=, &graph] { return WriteRobotMap(output.File("map"), graph, options.map_resolution_m); },
      [=, &graph] { return WritePointsPly(output.File("points.ply"), graph); },
      [=, &graph] { return WritePointsPcd(output.File("points.pcd"), graph); }};
  if (map.consistency != nullptr) {
    tasks.insert(tasks.begin(), [=, &graph] {
      return WriteConflictPicture(output.File("conflicts.png"), graph, *map.consistency,
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

Status RunAll(const std::vector<WriteTask>& tasks, ThreadPool* pool) {
  std::vector<Status> results(tasks.size());
  pool->ForEachChunk(tasks.size(), 1, [&](std::size_t, std::size_t begin, std::size_t) {
    results[begin] = tasks[begin]();
  });
  for (const Status& result : results) PLUMBLINE_RETURN_IF_ERROR(result);
  return Status::Ok();
}

}  // namespace plumbline
