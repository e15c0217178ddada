#ifndef PLUMBLINE_SOLVERS_ASSOCIATION_SURFACE_CELLS_H_
#define PLUMBLINE_SOLVERS_ASSOCIATION_SURFACE_CELLS_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {

/// Names a square cell of the plane and an octant of the directions that its surfaces face, so that
/// the two faces of a wall and the two sides of a corner never mix. Holds 32 bits per coordinate:
/// 200,000 km at cells of 0.1 m.
struct SurfaceCellKey {
  std::int64_t x = 0, y = 0;
  int octant = 0;  ///< 0 to 7, counter-clockwise

  bool operator==(const SurfaceCellKey& other) const {
    return x == other.x && y == other.y && octant == other.octant;
  }
};

/// Octant of a direction, given as a share of a full turn from the x axis, at least 0; octant 0 is
/// centred on that axis.
inline int OctantOf(double turns) { return static_cast<int>(8.0 * (turns + 1.0 / 16.0)) & 7; }

/// Returns in sum: where they end, and whether more than one pose saw them.
struct SummedReturns {
  static constexpr int kNoPose = -1;

  PointMoments moments;  ///< about the centre of a cell, in the frame of the grid
  int pose = kNoPose;    ///< one of the poses that saw them
  bool several_poses = false;

  /// other: about the same centre; nothing where it has no pose.
  void Merge(const SummedReturns& other) {
    if (other.pose == kNoPose) return;
    if (pose == kNoPose) pose = other.pose;
    moments += other.moments;
    several_poses = several_poses || other.several_poses || pose != other.pose;
  }
  /// The same returns about a centre moved by (-dx, -dy) [m].
  SummedReturns Shifted(double dx, double dy) const {
    return {moments.Shifted(dx, dy), pose, several_poses};
  }
};

/// The returns that ended in one cell.
struct SurfaceCell : SummedReturns {
  SurfaceCellKey key;
  int parent = -1;  ///< in the table of twice the cell size, once Coarsened has made it
};

/// Cells by key, in an open-addressing hash table of squares that hold eight cells each. Cells are
/// numbered in order of insertion, which makes every result independent of the hashing.
class SurfaceCells {
 public:
  static constexpr int kNone = -1;

  explicit SurfaceCells(double cell_m)
      : cell_m_(cell_m), inverse_cell_m_(1.0 / cell_m), slots_(1024) {}

  double cell_m() const { return cell_m_; }
  std::size_t size() const { return cells_.size(); }
  SurfaceCell& operator[](std::size_t id) { return cells_[id]; }
  const SurfaceCell& operator[](std::size_t id) const { return cells_[id]; }

  SurfaceCellKey KeyOf(double x, double y, int octant) const {
    return {Floor(x * inverse_cell_m_), Floor(y * inverse_cell_m_), octant};
  }
  /// In the frame of the grid [m].
  Eigen::Vector2d Center(const SurfaceCellKey& key) const {
    return {(static_cast<double>(key.x) + 0.5) * cell_m_,
            (static_cast<double>(key.y) + 0.5) * cell_m_};
  }

  /// The cells of one square by octant, kNone where there is none.
  const std::array<int, 8>& Square(std::int64_t x, std::int64_t y) const {
    return slots_[SlotOf(PackedSquare(x, y))].cell_of_octant;
  }
  int FindOrInsert(const SurfaceCellKey& key);

  /// The cells without their table, which is as large.
  std::vector<SurfaceCell> Take() && { return std::move(cells_); }

 private:
  struct Slot {
    std::uint64_t square = 0;
    bool taken = false;
    std::array<int, 8> cell_of_octant{kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  };

  static std::uint64_t PackedSquare(std::int64_t x, std::int64_t y) {
    return static_cast<std::uint64_t>(x) << 32 | (static_cast<std::uint64_t>(y) & 0xffffffff);
  }
  std::size_t SlotOf(std::uint64_t square) const {
    std::uint64_t hash = square * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 29;
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash & mask;
    while (slots_[slot].taken && slots_[slot].square != square) slot = (slot + 1) & mask;
    return slot;
  }
  void Grow();

  // std::floor is a call into the C library unless the build is for newer processors only.
  static std::int64_t Floor(double value) {
    const auto truncated = static_cast<std::int64_t>(value);
    return truncated - (static_cast<double>(truncated) > value ? 1 : 0);
  }

  double cell_m_;
  double inverse_cell_m_;
  std::vector<SurfaceCell> cells_;
  std::vector<Slot> slots_;
  std::size_t num_squares_ = 0;
};

/// The axes that cells and octants are laid along, as yaw angles in the world [rad].
struct SurfaceGrid {
  double cell_m = 0.0;
  double cell_yaw_rad = 0.0;
  /// Octant 0 is centred on this direction.
  double octant_yaw_rad = 0.0;
};

/// Direction [rad] that most walls are parallel or orthogonal to. Octants are to be centred on it:
/// an edge between two octants that lay on the walls would tear each wall in two.
double DominantDirection(const SlamGraph& graph, const std::vector<double>& poses,
                         const MeasuredSurface& surface, ThreadPool* pool);

/// Sorts the measured ends of all beams, placed by the poses, into cells. poses: (x, y, yaw) each.
/// cell_of_return: kNone for a return without a normal. With hold_out, held-out returns get their
/// cells but do not count in the moments. Bitwise the same for any number of threads.
/// Of a shared graph these are the cells of this process alone, see AddCellsOfPeers.
SurfaceCells SortIntoCells(const SlamGraph& graph, const std::vector<double>& poses,
                           const MeasuredSurface& surface, const SurfaceGrid& grid,
                           ThreadPool* pool, std::vector<int>* cell_of_return,
                           bool hold_out = false);

/// The table of twice the cell size, by joining 2 x 2 cells; links every cell to its parent.
SurfaceCells Coarsened(SurfaceCells* fine);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_SURFACE_CELLS_H_
