#ifndef PLUMBLINE_APPS_IO_OCCUPANCY_SCORES_H_
#define PLUMBLINE_APPS_IO_OCCUPANCY_SCORES_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plumbline/core/peers.h"

namespace plumbline {

/// An integer per cell of a grid, to which lines and whole areas are added.
///
/// Coordinates are in cells from the lower left corner: cell (x, y) has its centre at
/// (x + 0.5, y + 0.5). What lies outside is cut off. Coordinates are finite, at most 1e12.
///
/// Kept as differences along each row, so that an area costs as much as its outline is long, and in
/// blocks of which only those take memory that an outline or a line goes through: most of a large
/// map is unknown.
class OccupancyScores {
 public:
  OccupancyScores(int width, int height);

  /// To be called before the points of a scan: one that comes back to a cell it has just been to,
  /// as noise along the border of two cells does, adds to it only once.
  void BeginScan() { recent_.fill(kNone); }

  /// Adds `amount` to the cell that a point lies in.
  void AddToCell(const Eigen::Vector2d& point, std::int32_t amount);

  /// Adds `amount` to every cell that the line touches, but not to the one it comes from. Cells
  /// that follow each other share a side: nothing slips through.
  void AddToLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::int32_t amount);

  /// Adds one edge of a closed outline; all of them together add 1 to every cell whose centre they
  /// go around clockwise and -1 where they go around counter-clockwise.
  void AddEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  /// Adds what other processes have added to scores of a grid of the same size (collective): to
  /// those of process `rank`, or of all where it is kEveryRank. The others are empty afterwards.
  /// Whether this process has got the sum; true without peers.
  bool AddThoseOf(const Peers* peers, int rank);
  static constexpr int kEveryRank = -1;

  /// The scores of a row, one per cell.
  void Row(int y, std::vector<std::int32_t>* scores) const;

 private:
  static constexpr int kBlockSide = 64;
  static constexpr std::ptrdiff_t kCellsPerBlock = kBlockSide * kBlockSide;
  // Row by row; none where nothing was added.
  using Block = std::vector<std::int32_t>;

  void Add(std::int64_t x, std::int64_t y, std::int32_t amount);
  // x: up to width_. That of the last column is never read.
  std::int32_t& Difference(int x, int y) {
    Block& block =
        blocks_[static_cast<std::size_t>(y / kBlockSide) * blocks_per_row_ + x / kBlockSide];
    if (block.empty()) block.resize(kCellsPerBlock);
    return block[y % kBlockSide * kBlockSide + x % kBlockSide];
  }
  // Of the blocks from `begin` to before `end` that are not empty, the number and what they hold.
  std::vector<std::int32_t> Packed(std::size_t begin, std::size_t end) const;
  void AddPacked(const std::vector<std::int32_t>& packed);

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  const int width_, height_;
  const std::size_t blocks_per_row_;
  std::array<std::size_t, 4> recent_;  // the cells that were added to last
  std::size_t num_added_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_OCCUPANCY_SCORES_H_
