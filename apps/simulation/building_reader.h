#ifndef PLUMBLINE_APPS_SIMULATION_BUILDING_READER_H_
#define PLUMBLINE_APPS_SIMULATION_BUILDING_READER_H_

#include <string>

#include "plumbline/apps/simulation/world.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Reads a building from a text file, one record per line, blank-separated; lengths in m, angles in
/// deg, `#` starts a comment:
///
///   thickness t               of the walls below; 0.1 until stated
///   wall x1 y1 x2 y2          centre line of a wall
///   room x1 y1 x2 y2          four walls: a rectangle given by two opposite corners
///   door x1 y1 x2 y2          an opening in every wall of the file that runs along this segment
///   box x y width depth yaw   a rectangular piece of furniture: its centre, its sides
///   circle x y radius         a pillar or a round table
///   path x y                  the next point that the robot drives to
///
/// FloorPlan says what walls and doors look like.
///
/// NotFound, InvalidArgument or DataLoss if the file cannot be read. InvalidArgument, naming file,
/// line and field, on a record that is unknown, incomplete or degenerate, on a coordinate or size
/// beyond 1e5 m, on a door that opens no wall, on a building without surfaces and on a path of a
/// single point. `building` is then untouched.
Status ReadBuilding(const std::string& path, Building* building);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_BUILDING_READER_H_
