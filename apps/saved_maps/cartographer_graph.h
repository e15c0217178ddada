#ifndef PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_GRAPH_H_
#define PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_GRAPH_H_

#include <string>
#include <vector>

#include "plumbline/apps/saved_maps/cartographer_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What is to be known about a graph that a state of Cartographer has become.
struct CartographerGraphNotes {
  double sigma_m = 0.0, sigma_rad = 0.0;  ///< of a constraint
  int num_contradicted = 0;               ///< constraints that the saved poses contradict
  std::vector<int> frozen_trajectories;   ///< held where they are
};

/// Makes a graph of a state. Its poses are those of the nodes' tracking frames, in the order of the
/// state, and behind them those of the submaps, which have no scans.
///
/// Each point of a node is a return, kept up to rounding, of a laser in the origin of the tracking
/// frame: the file does not say where the lasers were. Its beams, which tell what returns are
/// neighbours, are as far apart as three quarters of the points are from the next by their
/// bearings.
///
/// Each constraint is a relative pose between submap and node. Cartographer's weights balance its
/// costs and are no covariances: taken for such, they stand for tenths of millimetres. Here sigma
/// is what the constraints are off at the saved poses (1.48 times the median), and at least that of
/// a position that is known to a cell of the grid, or of an angle that moves a point at the median
/// range as much. A constraint that is off by more than three sigmas, as wrong loop closures are,
/// gets a third of that as its sigma. A node without constraints, because its submap was not
/// finished, is tied to its neighbours by what the local SLAM says.
///
/// Trajectories without constraints within their submaps were loaded frozen, and are fixed; so are
/// submaps without constraints. If no trajectory is, the first submap is fixed, as in Cartographer:
/// the map stays where it is as a whole. InvalidArgument, naming the path, if all trajectories are
/// frozen, if constraints do not connect the others, and if the graph takes a number for
/// impossible.
Status BuildGraph(const CartographerState& state, const std::string& path, SlamGraph* graph,
                  CartographerGraphNotes* notes);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_GRAPH_H_
