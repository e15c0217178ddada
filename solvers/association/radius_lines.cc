// Tangent lines from all points within a radius, by way of a table of moments.
//
// The plane is cut into square cells of half the radius, and each cell by the octant that its
// points' normals fall into, so that the two faces of a wall and the two sides of a corner never
// mix. A cell's line is fitted to the moments of the disc of cells around it (5 x 5 without the
// corners) and of its own and the two neighbouring octants; all points of the cell share it. Where
// the disc holds too few points, or one scan only, the same is tried with twice the radius, and
// twice again.

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

enum class CellFit : char { kLine, kNotALine, kTooSparse };

// The cells around a square in one octant, its own included.
struct OctantAround {
  PointMoments moments;  // about the centre of the square
  int pose = kNoPose;    // one of those that saw them
  bool several_poses = false;

  static constexpr int kNoPose = -1;

  void Add(const PointMoments& other, int other_pose, bool other_several) {
    if (pose == kNoPose) pose = other_pose;
    moments += other;
    several_poses = several_poses || other_several || pose != other_pose;
  }
};
using Surroundings = std::array<OctantAround, 8>;

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
        around[octant].Add(cell.moments.Shifted(dx * cells.cell_m(), dy * cells.cell_m()),
                           cell.pose, cell.several_poses);
      }
    }
  }
  return around;
}

// Fits the line of one octant of a square.
CellFit FitOctant(const Surroundings& around, int octant, const Eigen::Vector2d& center,
                  const AssociationOptions& options, TangentLine* line) {
  OctantAround sum = around[octant];
  for (const int turn : {-1, 1}) {
    const OctantAround& beside = around[(octant + turn) & 7];
    if (beside.pose != OctantAround::kNoPose) {
      sum.Add(beside.moments, beside.pose, beside.several_poses);
    }
  }
  if (sum.moments.weight < options.min_points) return CellFit::kTooSparse;
  if (options.several_poses && !sum.several_poses) return CellFit::kTooSparse;
  const LineFit fit = FitLine(sum.moments);
  if (fit.EigenvalueRatio() > options.max_eigenvalue_ratio) return CellFit::kNotALine;
  *line = {fit.normal.x(), fit.normal.y(), fit.normal.dot(center + fit.centroid)};
  return CellFit::kLine;
}

// The cells of one size and their lines.
class CellLines {
 public:
  explicit CellLines(SurfaceCells cells) : cells_(std::move(cells)), is_wanted_(cells_.size()) {}

  SurfaceCells* cells() { return &cells_; }
  void WantAll() { is_wanted_.assign(cells_.size(), true); }
  // Those of which the cells of the next smaller size say too little.
  void WantParentsOfSparse(const CellLines& smaller) {
    for (std::size_t id = 0; id < smaller.cells_.size(); ++id) {
      if (smaller.IsTooSparse(id)) is_wanted_[smaller.Parent(id)] = true;
    }
  }

  // Fits those that are wanted.
  void Fit(const AssociationOptions& options, ThreadPool* pool) {
    constexpr std::size_t kCellsPerChunk = 256;
    fits_.assign(cells_.size(), CellFit::kNotALine);
    lines_.assign(cells_.size(), {0.0, 0.0, 0.0});
    pool->ForEachChunk(cells_.size(), kCellsPerChunk,
                       [&](std::size_t, std::size_t begin, std::size_t end) {
                         for (std::size_t id = begin; id < end; ++id) {
                           if (is_wanted_[id]) FitSquareOf(id, options);
                         }
                       });
  }

  bool IsTooSparse(std::size_t id) const { return fits_[id] == CellFit::kTooSparse; }
  std::size_t Parent(std::size_t id) const { return cells_[id].parent; }
  const TangentLine& Line(std::size_t id) const { return lines_[id]; }

 private:
  // All cells of a square lie in the same disc: the first one fits them all.
  void FitSquareOf(std::size_t first, const AssociationOptions& options) {
    const SurfaceCellKey& key = cells_[first].key;
    const std::array<int, 8>& square = cells_.Square(key.x, key.y);
    const auto is_asked = [this](int id) { return id != SurfaceCells::kNone && is_wanted_[id]; };
    std::array<bool, 8> octants{};
    for (int octant = 0; octant < 8; ++octant) {
      const int id = square[octant];
      if (!is_asked(id)) continue;
      if (static_cast<std::size_t>(id) < first) return;
      for (const int turn : {-1, 0, 1}) octants[(octant + turn) & 7] = true;
    }
    const Surroundings around = DiscAround(cells_, key, octants);
    for (int octant = 0; octant < 8; ++octant) {
      const int id = square[octant];
      if (!is_asked(id)) continue;
      fits_[id] = FitOctant(around, octant, cells_.Center(key), options, &lines_[id]);
    }
  }

  SurfaceCells cells_;
  std::vector<char> is_wanted_;  // per cell, as all below
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
  std::vector<CellLines> levels;
  levels.emplace_back(std::move(finest)).WantAll();
  levels.back().Fit(options, pool);
  while (static_cast<int>(levels.size()) < kNumLevels) {
    CellLines larger(Coarsened(levels.back().cells()));
    larger.WantParentsOfSparse(levels.back());
    larger.Fit(options, pool);
    levels.push_back(std::move(larger));
  }
  std::vector<TangentLine> line_of_cell;
  line_of_cell.reserve(levels.front().cells()->size());
  for (std::size_t id = 0; id < levels.front().cells()->size(); ++id) {
    std::size_t at = id;
    std::size_t level = 0;
    for (; level + 1 < levels.size() && levels[level].IsTooSparse(at); ++level) {
      at = levels[level].Parent(at);
    }
    line_of_cell.push_back(levels[level].Line(at));
  }
  return {std::move(line_of_cell), std::move(cell_of_return)};
}

}  // namespace plumbline
