#ifndef PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_STATE_H_
#define PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_STATE_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// How Cartographer names a node or a submap.
struct CartographerId {
  int trajectory = 0;
  int index = 0;  ///< within the trajectory, with gaps where something was trimmed

  bool operator<(const CartographerId& other) const {
    return std::tie(trajectory, index) < std::tie(other.trajectory, other.index);
  }
};

/// A scan and where it was taken.
struct CartographerNode {
  CartographerId id;
  double time_s = 0.0;                   ///< since 1970
  Pose2 map_from_tracking;               ///< the estimate
  Pose2 local_from_tracking;             ///< by the local SLAM, which knows of no loops
  double tracking_from_level_rad = 0.0;  ///< the points' frame has the same origin, turned by this
  /// In a level frame, on a raster of 1 mm.
  std::vector<Eigen::Vector2i> points_mm;
};

/// A piece of map of its own, a grid.
struct CartographerSubmap {
  CartographerId id;
  Pose2 map_from_submap;
};

/// What a match of a node against a submap says.
struct CartographerConstraint {
  int submap = 0, node = 0;  ///< index into the state's arrays
  bool is_intra = true;      ///< the node is one of those that the submap was made of
  Pose2 submap_from_tracking;
};

/// A map in 2D that Cartographer has saved.
struct CartographerState {
  std::vector<CartographerNode> nodes;  ///< trajectory by trajectory, in order of time
  std::vector<CartographerSubmap> submaps;
  std::vector<CartographerConstraint> constraints;
  std::optional<double> cell_m;  ///< side of a cell of the submaps' grids
  bool has_landmarks = false;
  std::string content;  ///< of the file
};

/// Tells a state of Cartographer, readable or not, by its extension (.pbstream) or its first bytes.
bool IsCartographerState(const std::string& path);

/// Reads a state (.pbstream) of format version 1 or 2, which are the same in 2D. DataLoss, naming
/// the file and the message (from 1), if it is damaged or cut off, or if its parts do not fit
/// together. InvalidArgument likewise if it is older, newer or in 3D, or takes more than max_bytes
/// of memory (0: no limit); NotFound or InvalidArgument if the file cannot be read. Replaces *state
/// on success only.
Status ReadCartographerState(const std::string& path, CartographerState* state,
                             double max_bytes = 0.0);

/// The same for what such a file holds.
Status ParseCartographerState(const std::string& path, std::string content,
                              CartographerState* state);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_CARTOGRAPHER_STATE_H_
