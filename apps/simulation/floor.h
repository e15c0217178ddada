#ifndef PLUMBLINE_APPS_SIMULATION_FLOOR_H_
#define PLUMBLINE_APPS_SIMULATION_FLOOR_H_

#include <cstdint>
#include <vector>

#include "plumbline/apps/simulation/world.h"

namespace plumbline {

/// How the drive goes from crossing to crossing.
enum class RouteKind {
  kWander,  ///< at random, but it never turns back
  /// Around one block after the other from west to east, back along the northern corridor, and
  /// again: the part of the floor that it has seen grows steadily.
  kTour,
};

/// Sizes of a generated floor, x to the east and y to the north:
///
///     rooms of the south side                    row 0
///     southern corridor, from end to end
///     blocks, with cross corridors in between    row 1 | core | row 2
///     northern corridor, from end to end
///     rooms of the north side                    row 3
///
/// Widths and depths are those between the centre lines of walls.
struct FloorStyle {
  std::vector<double> block_widths_m;  ///< from the west; at least three
  double row_depths_m[4] = {};         ///< of the rooms, from the south
  double core_depth_m = 0.0;           ///< solid, behind the rooms of rows 1 and 2
  double corridor_width_m = 0.0;
  double cross_corridor_width_m = 0.0;
  double corridor_wall_m = 0.12;  ///< thickness
  double room_width_m = 0.0;      ///< mean; rows are cut into rooms about this wide
  double door_width_m = 0.95;     ///< each room has one, to the corridor
  /// From 0: all rooms of a row are alike, furniture included, to 1: no two are.
  double irregularity = 0.0;
  /// From 0: everything but pillars is at right angles, to 1: one partition in three bends, and
  /// furniture leans.
  double slant = 0.0;
  int furniture_per_room = 0;  ///< pieces, as far as there is space for them
  double furniture_per_corridor_m = 0.0;
  /// The same walls on another day, if it is not 0: one piece of furniture in three stands
  /// elsewhere in its room or corridor, pillars excepted, and the drive begins and goes elsewhere.
  std::uint64_t visit = 0;
  RouteKind route = RouteKind::kWander;
  /// Of going into a room on the way from one cross corridor to the next.
  double visit_probability = 0.0;
  /// The drive ends at the first crossing after this length at which it has closed a loop [m].
  double drive_length_m = 0.0;
};

/// A seed for what is different on a visit, as its noise; the same one on visit 0.
std::uint64_t SeedOfVisit(std::uint64_t seed, std::uint64_t visit);

/// Draws the floor that the style and the seed describe, and a drive through it; without a name.
Building MakeFloor(const FloorStyle& style, std::uint64_t seed);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_FLOOR_H_
