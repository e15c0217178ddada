#ifndef PLUMBLINE_APPS_IO_ROS_MAP_H_
#define PLUMBLINE_APPS_IO_ROS_MAP_H_

#include <string>

#include "plumbline/apps/io/occupancy_grid.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Writes a map for robots as the map servers of ROS and Nav2 read it: stem.pgm, binary, the row
/// with the largest y first, 0 occupied, 254 free, 205 unknown; and stem.yaml, with the cells' size
/// [m] and the world coordinates of the lower left pixel's lower left corner.
///
/// free_thresh is 0.196, as ROS 1 saves it: 205 stands for (255 - 205) / 255 = 0.19608, which
/// Nav2's default of 0.25 would take for free. The file's own value counts in both.
///
/// Needs a grid that is not empty. Unavailable if a file cannot be written; either of
/// them is whole or left as it was.
Status WriteRosMap(const std::string& stem, const OccupancyGrid& grid);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_ROS_MAP_H_
