#ifndef PLUMBLINE_APPS_LIVE_LIVE_MAP_H_
#define PLUMBLINE_APPS_LIVE_LIVE_MAP_H_

#include <mutex>
#include <vector>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/online_mapper.h"

namespace plumbline {

/// The map of a live drive as robots use it, in the frame of the map.
struct LiveMap {
  double stamp_s = 0.0;  ///< of the newest scan in it
  OccupancyGrid grid;
  std::vector<TimedPose> path;  ///< of the robot, at the scans in the grid
  int num_scans = 0;            ///< that were mapped so far
  int num_closures = 0;
  std::vector<Alarm> alarms;
};

/// Makes occupancy grids from some scans of a drive: one per 0.1 m or 0.1 rad of motion; with the
/// scans of a saved map that the drive continues, or of this map alone if its poses are fixed. Add
/// and Build may be called from two threads.
class LiveMapBuilder {
 public:
  /// saved_map: as SavedMap::graph; null: there is none.
  LiveMapBuilder(const LaserModel& laser, const SlamGraph* saved_map);

  /// Takes a scan into the grids if the robot has moved since the last one that was taken.
  /// index: of the scan in the mapper; stamp_s: for the path.
  void Add(int index, double stamp_s, const LaserScan& scan, const Pose2& map_from_robot);

  /// Builds the map of all scans that were taken, with the poses that `mapper` has now, in cells of
  /// `resolution_m` or coarser ones if it is huge. mapper: has all scans of Add. Fails like
  /// BuildOccupancyGrid; InvalidArgument without scans.
  Status Build(const OnlineMapper& mapper, double resolution_m, LiveMap* live_map);

 private:
  struct KeyScan {
    int index = 0;
    double stamp_s = 0.0;
    LaserScan scan;
  };

  // Moves the new scans into the graph.
  Status TakeNewScans();
  // The grid of all scans of the graph; the scans of the drive lie at the path of `map`.
  Status BuildGrid(const LiveMap& map, double resolution_m, OccupancyGrid* grid);

  const LaserModel laser_;
  bool is_fixed_ = false;
  std::mutex mutex_;          // of the new scans
  std::vector<KeyScan> new_;  // not in the graph yet
  bool has_last_ = false;
  Pose2 last_;                    // of the last scan that was taken
  std::mutex building_;           // of the graph
  SlamGraph graph_;               // first the saved map
  OccupancyGrid fixed_grid_;      // of a map with fixed poses, once it is built
  std::vector<int> indices_;      // per scan of the graph
  std::vector<double> stamps_s_;  // per scan of the graph
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_LIVE_LIVE_MAP_H_
