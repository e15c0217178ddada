#include "plumbline/apps/figures/choose_details.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>

#include "plumbline/core/line_fit.h"

namespace plumbline {
namespace {

// As wide as the neighbourhoods in which the sharpness of maps is measured.
constexpr double kCellM = 0.3;
constexpr double kMinPoints = 10.0;       // less tells no thickness
constexpr double kMaxLineRatio = 0.15;    // of eigenvalues; rounder is no surface
constexpr double kMinDifferenceM = 1e-3;  // less is rounding, and not to be seen
constexpr int kBlocksPerWindow = 4;       // windows lie on a grid of this fraction of their size

using GridCell = std::pair<double, double>;  // place on a grid, in whole cells

GridCell CellOf(double x, double y, double size) {
  return {std::floor(x / size), std::floor(y / size)};
}

// The returns that share a cell of the map `after`, in both maps.
struct CellReturns {
  PointMoments before, after;
  Eigen::Vector2d before_origin = Eigen::Vector2d::Zero();  // of the moments
};

double Thickness(const LineFit& fit) { return std::sqrt(std::max(0.0, fit.smaller_eigenvalue)); }

std::map<GridCell, CellReturns> CollectCells(const std::vector<double>& before,
                                             const std::vector<double>& after) {
  std::map<GridCell, CellReturns> cells;
  for (std::size_t i = 0; i + 1 < after.size(); i += 2) {
    const Eigen::Vector2d from(before[i], before[i + 1]), to(after[i], after[i + 1]);
    if (!from.allFinite() || !to.allFinite()) continue;
    const GridCell cell = CellOf(to.x(), to.y(), kCellM);
    CellReturns* returns = &cells[cell];
    if (returns->after.weight == 0.0) returns->before_origin = from;
    returns->after.Add(to.x() - kCellM * cell.first, to.y() - kCellM * cell.second);
    returns->before.Add(from.x() - returns->before_origin.x(),
                        from.y() - returns->before_origin.y());
  }
  return cells;
}

// Differences summed over the blocks of the windows' grid.
std::map<GridCell, double> SumBlocks(const std::map<GridCell, CellReturns>& cells, double size_m) {
  std::map<GridCell, double> blocks;
  for (const auto& [cell, returns] : cells) {
    if (returns.after.weight < kMinPoints) continue;
    const LineFit after = FitLine(returns.after);
    if (after.EigenvalueRatio() > kMaxLineRatio) continue;
    const double thicker = Thickness(FitLine(returns.before)) - Thickness(after);
    if (!(thicker >= kMinDifferenceM)) continue;
    blocks[CellOf(kCellM * (cell.first + 0.5), kCellM * (cell.second + 0.5),
                  size_m / kBlocksPerWindow)] += std::min(thicker, 0.25 * size_m);
  }
  return blocks;
}

// By the block at their lower left corner; only windows with a difference.
std::map<GridCell, double> SumWindows(const std::map<GridCell, double>& blocks) {
  std::map<GridCell, double> windows;
  for (const auto& [block, difference] : blocks) {
    for (int dx = 0; dx < kBlocksPerWindow; ++dx) {
      for (int dy = 0; dy < kBlocksPerWindow; ++dy) {
        windows[{block.first - dx, block.second - dy}] += difference;
      }
    }
  }
  return windows;
}

bool Overlap(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double size_m) {
  return (a - b).cwiseAbs().maxCoeff() < size_m * (1.0 - 1e-9);
}

Eigen::Vector2d CenterOf(const GridCell& window, double size_m) {
  const double block_m = size_m / kBlocksPerWindow;
  return {window.first * block_m + 0.5 * size_m, window.second * block_m + 0.5 * size_m};
}

// Where the differences in a window are, in the mean: what is to be seen is better not at its edge.
Eigen::Vector2d Centroid(const std::map<GridCell, double>& blocks, const Eigen::Vector2d& center,
                         double size_m) {
  const double block_m = size_m / kBlocksPerWindow;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double total = 0.0;
  for (const auto& [block, difference] : blocks) {
    const Eigen::Vector2d middle((block.first + 0.5) * block_m, (block.second + 0.5) * block_m);
    if ((middle - center).cwiseAbs().maxCoeff() > 0.5 * size_m) continue;
    sum += difference * middle;
    total += difference;
  }
  return sum / total;
}

}  // namespace

std::vector<MapWindow> ChooseDetails(const std::vector<double>& before,
                                     const std::vector<double>& after, int count, double size_m) {
  const std::map<GridCell, double> blocks = SumBlocks(CollectCells(before, after), size_m);
  std::map<GridCell, double> windows = SumWindows(blocks);
  std::vector<MapWindow> chosen;
  while (static_cast<int>(chosen.size()) < count && !windows.empty()) {
    const auto best =
        std::max_element(windows.begin(), windows.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    const GridCell at = best->first;
    const Eigen::Vector2d on_grid = CenterOf(at, size_m);
    const Eigen::Vector2d centered = Centroid(blocks, on_grid, size_m);
    const bool is_free = std::none_of(chosen.begin(), chosen.end(), [&](const MapWindow& other) {
      return Overlap(other.center_m, centered, size_m);
    });
    chosen.push_back({is_free ? centered : on_grid, size_m, size_m});
    for (auto it = windows.begin(); it != windows.end();) {
      const bool overlaps =
          it->first == at || Overlap(CenterOf(it->first, size_m), chosen.back().center_m, size_m);
      it = overlaps ? windows.erase(it) : std::next(it);
    }
  }
  return chosen;
}

}  // namespace plumbline
