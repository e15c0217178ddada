// Tangent lines from all points within a radius, by way of a table of moments.
//
// The plane is cut into square cells of half the radius, and each cell by the octant that its
// points' normals fall into, so that the two faces of a wall and the two sides of a corner never
// mix. A cell's line is fitted to the moments of the disc of cells around it (5 x 5 without the
// corners) and of its own and the two neighbouring octants; all points of the cell share it. Where
// the disc holds too few points, or one scan only, the same is tried with twice the radius, and
// twice again.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "plumbline/core/line_fit.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/shared_cells.h"
#include "plumbline/solvers/association/surface_cells.h"

namespace plumbline {
namespace {

constexpr int kNumLevels = 3;
// Fewest points of a line; fewer do not tell a surface from clutter.
constexpr double kMinPointsOfLine = 10.0;

enum class CellFit : char { kLine, kNotALine, kTooSparse };

// What lies in the disc around a square, its own cells included: by octant, about its centre.
using Surroundings = std::array<SummedReturns, 8>;

// octants: which ones to look at.
Surroundings DiscAround(const SurfaceCells& cells, const SurfaceCellKey& key,
                        const std::array<bool, 8>& octants) {
  Surroundings around;
  for (int dx = -2; dx <= 2; ++dx) {
    for (int dy = -2; dy <= 2; ++dy) {
      if (std::abs(dx * dy) == 4) continue;
      const std::array<int, 8>& square = cells.Square(key.x + dx, key.y + dy);
      for (int octant = 0; octant < 8; ++octant) {
        if (!octants[octant] || square[octant] == SurfaceCells::kNone) continue;
        const SurfaceCell& cell = cells[square[octant]];
        around[octant].Merge(cell.Shifted(dx * cells.cell_m(), dy * cells.cell_m()));
      }
    }
  }
  return around;
}

// Fits the line of one octant of a square.
CellFit FitOctant(const Surroundings& around, int octant, const Eigen::Vector2d& center,
                  const AssociationOptions& options, TangentLine* line) {
  SummedReturns sum = around[octant];
  for (const int turn : {-1, 1}) sum.Merge(around[(octant + turn) & 7]);
  if (sum.moments.weight < kMinPointsOfLine) return CellFit::kTooSparse;
  if (options.several_poses && !sum.several_poses) return CellFit::kTooSparse;
  const LineFit fit = FitLine(sum.moments);
  if (fit.EigenvalueRatio() > kMaxEigenvalueRatio) return CellFit::kNotALine;
  *line = {fit.normal.x(), fit.normal.y(), fit.normal.dot(center + fit.centroid)};
  return CellFit::kLine;
}

// A cell of the finest table that has no line yet.
struct OpenCell {
  int id = 0;
  int within = 0;  // the cell that holds it in the table looked at
};

// Lines of those cells of a table that hold an open one.
class CellLines {
 public:
  CellLines(const SurfaceCells& cells, const std::vector<OpenCell>& open,
            const AssociationOptions& options, ThreadPool* pool)
      : cells_(cells),
        options_(options),
        is_asked_(cells.size()),
        fits_(cells.size(), CellFit::kNotALine),
        lines_(cells.size(), {0.0, 0.0, 0.0}) {
    for (const OpenCell& cell : open) is_asked_[cell.within] = 1;
    constexpr std::size_t kCellsPerChunk = 256;
    pool->ForEachChunk(cells.size(), kCellsPerChunk,
                       [this](std::size_t, std::size_t begin, std::size_t end) {
                         for (std::size_t id = begin; id < end; ++id) {
                           if (is_asked_[id] != 0) FitSquareOf(id);
                         }
                       });
  }

  bool IsTooSparse(std::size_t id) const { return fits_[id] == CellFit::kTooSparse; }
  const TangentLine& Line(std::size_t id) const { return lines_[id]; }

 private:
  // All cells of a square lie in the same disc: the first that is asked fits them all.
  void FitSquareOf(std::size_t first) {
    const SurfaceCellKey& key = cells_[first].key;
    const std::array<int, 8>& square = cells_.Square(key.x, key.y);
    std::array<bool, 8> is_needed{};
    for (int octant = 0; octant < 8; ++octant) {
      const int id = square[octant];
      if (!IsAsked(id)) continue;
      if (static_cast<std::size_t>(id) < first) return;
      for (const int turn : {-1, 0, 1}) is_needed[(octant + turn) & 7] = true;
    }
    const Surroundings around = DiscAround(cells_, key, is_needed);
    for (int octant = 0; octant < 8; ++octant) {
      const int id = square[octant];
      if (!IsAsked(id)) continue;
      fits_[id] = FitOctant(around, octant, cells_.Center(key), options_, &lines_[id]);
    }
  }

  bool IsAsked(int id) const { return id != SurfaceCells::kNone && is_asked_[id] != 0; }

  const SurfaceCells& cells_;
  const AssociationOptions& options_;
  std::vector<char> is_asked_;  // per cell, as all below
  std::vector<CellFit> fits_;
  std::vector<TangentLine> lines_;  // zero: none
};

}  // namespace

TangentLines LinesFromRadius(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const AssociationOptions& options,
                             double radius_m, ThreadPool* pool) {
  static_assert(TangentLines::kNone == SurfaceCells::kNone);
  const SurfaceGrid grid{0.5 * radius_m, 0.0, DominantDirection(graph, poses, surface, pool)};
  std::vector<int> cell_of_return;
  SurfaceCells finest = SortIntoCells(graph, poses, surface, grid, pool, &cell_of_return);
  AddCellsOfPeers(graph, poses, surface, grid, CellReach::kAround, &finest, &cell_of_return);
  std::vector<TangentLine> line_of_cell(finest.size(), {0.0, 0.0, 0.0});
  std::vector<OpenCell> open;
  open.reserve(finest.size());
  for (int id = 0; id < static_cast<int>(finest.size()); ++id) open.push_back({id, id});
  SurfaceCells cells = std::move(finest);
  for (int level = 0; level < kNumLevels && !open.empty(); ++level) {
    if (level > 0) {
      SurfaceCells larger = Coarsened(&cells);
      for (OpenCell& cell : open) cell.within = cells[cell.within].parent;
      cells = std::move(larger);
    }
    const CellLines lines(cells, open, options, pool);
    for (const OpenCell& cell : open) line_of_cell[cell.id] = lines.Line(cell.within);
    const auto is_settled = [&](const OpenCell& cell) { return !lines.IsTooSparse(cell.within); };
    open.erase(std::remove_if(open.begin(), open.end(), is_settled), open.end());
  }
  return {std::move(line_of_cell), std::move(cell_of_return)};
}

}  // namespace plumbline
