// Tangent lines from all points within a radius, by way of a table of moments.
//
// The plane is cut into square cells of half the radius, and each cell by the octant that its
// points' normals fall into, so that the two faces of a wall and the two sides of a corner never
// mix. A cell's line is fitted to the moments of the disc of cells around it (5 x 5 without the
// corners) and of its own and the two neighbouring octants; all points of the cell share it. Where
// the disc holds too few points, or one scan only, the same is tried with twice the radius, and
// twice again.

#include <cmath>
#include <utility>

#include "plumbline/core/line_fit.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/shared_cells.h"
#include "plumbline/solvers/association/surface_cells.h"

namespace plumbline {
namespace {

constexpr int kNumLevels = 3;

enum class CellFit { kLine, kNotALine, kTooSparse };

// Fits the line of one entry to the disc of cells around it.
CellFit FitCell(const SurfaceCells& cells, const SurfaceCell& cell,
                const AssociationOptions& options, TangentLine* line) {
  PointMoments sum;
  bool enough_poses = cell.several_poses || !options.several_poses;
  for (int dx = -2; dx <= 2; ++dx) {
    for (int dy = -2; dy <= 2; ++dy) {
      if (std::abs(dx * dy) == 4) continue;
      const std::array<int, 8>& square = cells.Square(cell.key.x + dx, cell.key.y + dy);
      for (int turn = -1; turn <= 1; ++turn) {
        const int id = square[(cell.key.octant + turn) & 7];
        if (id == SurfaceCells::kNone) continue;
        const SurfaceCell& other = cells[id];
        sum += other.moments.Shifted(dx * cells.cell_m(), dy * cells.cell_m());
        enough_poses = enough_poses || other.several_poses || other.pose != cell.pose;
      }
    }
  }
  if (sum.weight < options.min_points || !enough_poses) return CellFit::kTooSparse;
  const LineFit fit = FitLine(sum);
  if (fit.EigenvalueRatio() > options.max_eigenvalue_ratio) return CellFit::kNotALine;
  const Eigen::Vector2d centroid = cells.Center(cell.key) + fit.centroid;
  *line = {fit.normal.x(), fit.normal.y(), fit.normal.dot(centroid)};
  return CellFit::kLine;
}

// The line of a cell of the finest table, at the first radius that is not too sparse.
TangentLine LineOfCell(const std::vector<SurfaceCells>& tables, std::size_t id,
                       const AssociationOptions& options) {
  TangentLine line{0.0, 0.0, 0.0};
  for (const SurfaceCells& cells : tables) {
    const SurfaceCell& cell = cells[id];
    if (FitCell(cells, cell, options, &line) != CellFit::kTooSparse) break;
    id = static_cast<std::size_t>(cell.parent);
  }
  return line;
}

}  // namespace

TangentLines LinesFromRadius(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const AssociationOptions& options,
                             double radius_m, ThreadPool* pool) {
  static_assert(TangentLines::kNone == SurfaceCells::kNone);
  const SurfaceGrid grid{0.5 * radius_m, 0.0, DominantDirection(graph, poses, surface, pool)};
  std::vector<int> cell_of_return;
  std::vector<SurfaceCells> tables;
  tables.push_back(SortIntoCells(graph, poses, surface, grid, pool, &cell_of_return));
  AddCellsOfPeers(graph, poses, surface, grid, CellReach::kAround, &tables.front(),
                  &cell_of_return);
  while (static_cast<int>(tables.size()) < kNumLevels) tables.push_back(Coarsened(&tables.back()));

  std::vector<TangentLine> line_of_cell(tables.front().size());
  constexpr std::size_t kCellsPerChunk = 1024;
  pool->ForEachChunk(line_of_cell.size(), kCellsPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t id = begin; id < end; ++id) {
                         line_of_cell[id] = LineOfCell(tables, id, options);
                       }
                     });
  return {std::move(line_of_cell), std::move(cell_of_return)};
}

}  // namespace plumbline
