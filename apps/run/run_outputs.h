#ifndef PLUMBLINE_APPS_RUN_RUN_OUTPUTS_H_
#define PLUMBLINE_APPS_RUN_RUN_OUTPUTS_H_

#include <string>
#include <vector>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/pictures/map_picture.h"
#include "plumbline/apps/program/output_folder.h"
#include "plumbline/apps/run/write_tasks.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/map_consistency.h"
#include "plumbline/solvers/map_log.h"

namespace plumbline {

/// What every run that has scans is asked for.
struct RunOutputOptions {
  int picture_side_px = 2400;      ///< longer side of a picture's map, at most
  double map_resolution_m = 0.05;  ///< side of a cell of map.pgm
  /// Most cells of map.pgm: a map that would need more gets coarser ones.
  double map_max_cells = 4e8;
  bool save_map = false;  ///< also write map.g2o, the poses with all scans

  bool Check(std::string* error) const;
  /// Keeps the memory that map.pgm takes while it is made below this [bytes].
  void LimitGrid(double bytes);
  /// Those of map.pgm.
  OccupancyGridOptions GridOptions() const;
};

/// The refined map of a run, to be written.
struct RefinedMap {
  const SlamGraph* graph = nullptr;
  const MapState* state = nullptr;                    ///< of the graph
  const std::vector<double>* poses_before = nullptr;  ///< of the start, as MapState::poses
  std::string before_title;                           ///< what the start was
  const MapConsistency* consistency = nullptr;        ///< null where it was not measured
  MapArea* picture_area = nullptr;  ///< becomes where map_refined.png shows the map; may be null
  /// Becomes a line for people if the cells of map.pgm are coarser than asked for; may be null.
  std::string* map_warning = nullptr;
};

/// That of a log. Refers to the mapping.
RefinedMap RefinedMapOf(const LogMapping& mapping);

/// The task that draws a map picture of up to `side_px` pixels. Refers to graph, state and area;
/// *area, unless null, becomes where the picture shows the map.
WriteTask DrawTask(const std::string& path, const SlamGraph& graph, const MapState& state,
                   MapPictureOptions picture, int side_px, MapArea* area = nullptr);

/// The tasks that write map_refined.png, before_after.png, points.ply, points.pcd, map.pgm with
/// map.yaml and, if the consistency was measured, conflicts.png: the points first, for which the
/// disk needs time, then the longest ones. They refer to what they are given and do not change it;
/// each may run on a thread of its own, unless the graph has peers. To be run once.
std::vector<WriteTask> MapWriteTasks(const RefinedMap& map, const RunOutputOptions& options,
                                     const OutputFolder& output);

/// Writes stem.pgm and stem.yaml, the occupancy grid of the graph's scans and the state's map
/// points in cells of `resolution_m` [m]. Fails like BuildOccupancyGrid and WriteRosMap.
Status WriteRobotMap(const std::string& stem, const SlamGraph& graph, const MapState& state,
                     double resolution_m);

/// Writes the poses of a map with all of its scans as a pose graph in g2o's format, from which
/// other runs read it back bit by bit. motion: the noise of the odometry. A graph with peers gets
/// one with the scans of all (collective). Fails like WritePoseGraph.
Status WriteSavedMap(const std::string& path, const SlamGraph& graph,
                     const std::vector<double>& poses, const MotionOptions& motion);

/// InvalidArgument, with `input` in front, if this map is too large for WriteRobotMap.
Status CheckRobotMap(const std::string& input, const SlamGraph& graph, const MapState& state,
                     double resolution_m);

/// Lines for people: what the files of MapWriteTasks are.
std::string MapFilesText(bool with_conflicts);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_RUN_OUTPUTS_H_
