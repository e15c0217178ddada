#ifndef PLUMBLINE_APPS_IO_OCCUPANCY_GRID_H_
#define PLUMBLINE_APPS_IO_OCCUPANCY_GRID_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

enum class Occupancy : std::uint8_t { kUnknown, kFree, kOccupied };

/// Square cells on a grid through the world's origin.
struct OccupancyGrid {
  double resolution_m = 0.0;            ///< side of a cell
  double left_m = 0.0, bottom_m = 0.0;  ///< world coordinates of the lower left corner
  int width = 0, height = 0;
  std::vector<Occupancy> cells;  ///< row by row, the one with the smallest y first

  Occupancy At(int column, int row) const {
    return cells[static_cast<std::size_t>(row) * width + column];
  }
};

struct OccupancyGridOptions {
  static constexpr double kBytesPerCell = 5.0;  ///< what a cell takes at most while it is built

  double resolution_m = 0.05;  ///< from a millimetre to 100 m, a cell of which holds a building
  /// Most cells of a grid.
  double max_cells = 4e8;
  /// Doubles the side of a cell until a larger grid fits, instead of refusing it.
  bool coarsen_to_fit = false;

  bool Check(std::string* error) const;
};

/// InvalidArgument if a map of this extent needs more than max_cells: an early word on what
/// BuildOccupancyGrid would say. Needs poses, all of them finite. *num_cells, if not null: that the
/// grid has.
Status CheckGridSize(const SlamGraph& graph, const MapState& state,
                     const OccupancyGridOptions& options, double* num_cells = nullptr);

/// Finds out where a robot could drive, from all scans of a graph and the map points of a state.
///
/// *Surface*: a scan touches the cells its map points lie in, and those between two points up to
/// 0.3 m apart that one surface joins, so that walls are closed where beams are farther apart than
/// a cell.
/// *Free space*: between two neighbouring beams a scan looks through all cells whose centres lie
/// before the line through the two map points; not those that this line touches, so that beams
/// which graze a wall do not wear it off, and nothing where the beams are more than 0.3 m apart or
/// one of them goes more than 0.3 m farther than the other. A beam without a return tells nothing:
/// glass and black cloth look like open space.
/// *Classification*: occupied if more than a quarter of the scans that tell about a cell touch it,
/// so that people who pass disappear, and a surface at the border of two cells stays in one of
/// them; free otherwise; unknown if no scan tells anything, or exactly as much for either. An
/// occupied cell that rests on one scan and has no occupied neighbour is a stray return: unknown.
///
/// The grid holds the whole trajectory and all but the farthest 0.01 % of the points at each side.
/// Time grows with the length of what the scans outline, not with the area they see.
///
/// A graph with peers gets the grid of the scans of all (collective).
///
/// InvalidArgument on options out of range, a graph without poses or with poses that are not
/// finite, and a map that needs more than max_cells, unless it may be coarser. Points that are not
/// finite are left out.
Status BuildOccupancyGrid(const SlamGraph& graph, const MapState& state,
                          const OccupancyGridOptions& options, OccupancyGrid* grid);

/// The same from some of all scans: those from `first_scan` on. The grid still holds the whole map,
/// so that grids of different scans have the same cells.
Status BuildOccupancyGrid(const SlamGraph& graph, const MapState& state, int first_scan,
                          int num_scans, const OccupancyGridOptions& options, OccupancyGrid* grid);

/// The same as the first for process `rank` alone (collective): the others get a grid without cells
/// and keep nothing of it. `rank` does not matter for a graph without peers.
Status GatherOccupancyGrid(const SlamGraph& graph, const MapState& state,
                           const OccupancyGridOptions& options, int rank, OccupancyGrid* grid);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_OCCUPANCY_GRID_H_
