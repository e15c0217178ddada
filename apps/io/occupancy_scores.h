#ifndef PLUMBLINE_APPS_IO_OCCUPANCY_SCORES_H_
#define PLUMBLINE_APPS_IO_OCCUPANCY_SCORES_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plumbline/core/over_peers.h"

namespace plumbline {

/// An integer per cell of a grid, to which lines and whole areas are added.
///
/// Coordinates are in cells from the lower left corner: cell (x, y) has its centre at
/// (x + 0.5, y + 0.5). What lies outside is cut off. Coordinates are finite, at most 1e12.
///
/// Kept as differences along each row, so that an area costs as much as its outline is long.
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

  /// Adds what other processes have added to scores of a grid of the same size (collective).
  void AddThoseOf(const Peers* peers) { SumOverPeers(peers, &differences_); }

  /// The scores of a row, one per cell.
  void Row(int y, std::vector<std::int32_t>* scores) const;

 private:
  void Add(std::int64_t x, std::int64_t y, std::int32_t amount);

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  const int width_, height_;
  std::array<std::size_t, 4> recent_;  // the cells that were added to last
  std::size_t num_added_ = 0;
  std::vector<std::int32_t> differences_;  // width_ + 1 per row: the last one is never read
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_OCCUPANCY_SCORES_H_
