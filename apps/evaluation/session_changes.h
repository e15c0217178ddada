#ifndef PLUMBLINE_APPS_EVALUATION_SESSION_CHANGES_H_
#define PLUMBLINE_APPS_EVALUATION_SESSION_CHANGES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A session of a map, as pictures and reports show it.
struct SessionMark {
  std::string name;
  int number = 0;      ///< among all sessions, from 0: says which colour it has
  int first_scan = 0;  ///< among all; its scans follow each other
  int num_scans = 0;
};

/// A surface that one session shows where others looked through: furniture that was moved, a door.
struct SessionChange {
  int shown_by = 0;                                  ///< index among the sessions of the map
  std::vector<int> looked_through_by;                ///< likewise, in ascending order
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< world frame [m]
  double size_m = 0.0;                               ///< longer side of its bounding box
  std::vector<Eigen::Vector2d> points;               ///< map points of it, world frame [m]
};

/// What is different between the sessions of a map, by the occupancy grids of each: cells that are
/// occupied in the one and free in the other, next to nothing that is occupied there. Cells up to
/// one apart are one change; what is shorter than 0.3 m is none. In order of the sessions that show
/// them, the larger ones first. Processes that share the graph all get those of all scans
/// (collective). Fails like BuildOccupancyGrid.
Status FindSessionChanges(const SlamGraph& graph, const MapState& state,
                          const std::vector<SessionMark>& sessions,
                          const OccupancyGridOptions& options, std::vector<SessionChange>* changes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_SESSION_CHANGES_H_
