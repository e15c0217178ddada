#ifndef PLUMBLINE_SOLVERS_ASSOCIATION_SHARED_CELLS_H_
#define PLUMBLINE_SOLVERS_ASSOCIATION_SHARED_CELLS_H_

#include <cstdint>
#include <map>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/solvers/association/surface_cells.h"

namespace plumbline {

/// A square block of 8 x 8 squares of cells: the largest cell that any table is coarsened to, or
/// larger.
struct CellBlock {
  static constexpr int kLog2Side = 3;  ///< in squares of the finest table

  std::int64_t x = 0, y = 0;

  /// The block of a square in a table that was coarsened `level` times.
  static CellBlock Of(std::int64_t square_x, std::int64_t square_y, int level = 0) {
    return {square_x >> (kLog2Side - level), square_y >> (kLog2Side - level)};
  }
  bool operator==(const CellBlock& other) const { return x == other.x && y == other.y; }
  bool operator<(const CellBlock& other) const { return x != other.x ? x < other.x : y < other.y; }
};

/// The blocks that several peers have asked for: their ranks, ascending, this one included.
using SharedBlocks = std::map<CellBlock, std::vector<int>>;

/// Which blocks of cells a process wants to know.
enum class CellReach {
  kReturns,  ///< those that its returns end in, with or without a normal
  kAround,   ///< those of its cells, and the eight blocks around each
};

/// Adds to the cells of this process, as SortIntoCells gives them, those of its peers in all blocks
/// within reach, and renames the cells of its returns. All processes that want a block then have
/// the same cells there, with the same moments bit by bit, and number them in the same order. Gives
/// the blocks that others want as well. Collective; does nothing for a graph that is not shared.
SharedBlocks AddCellsOfPeers(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const SurfaceGrid& grid,
                             CellReach reach, SurfaceCells* cells,
                             std::vector<int>* cell_of_return);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_SHARED_CELLS_H_
