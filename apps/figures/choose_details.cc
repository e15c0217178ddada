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

using Cell = std::pair<double, double>;  // place on a grid, in whole cells

Cell CellOf(double x, double y, double size) {
  return {std::floor(x / size), std::floor(y / size)};
}

// The returns that share a cell of the map `after`, in both maps.
struct CellReturns {
  PointMoments before, after;
  Eigen::Vector2d before_origin = Eigen::Vector2d::Zero();  // of the moments
};

double Thickness(const LineFit& fit) { return std::sqrt(std::max(0.0, fit.smaller_eigenvalue)); }

std::map<Cell, CellReturns> CollectCells(const std::vector<double>& before,
                                         const std::vector<double>& after) {
  std::map<Cell, CellReturns> cells;
  for (std::size_t i = 0; i + 1 < after.size(); i += 2) {
    const Eigen::Vector2d from(before[i], before[i + 1]), to(after[i], after[i + 1]);
    if (!from.allFinite() || !to.allFinite()) continue;
    const Cell cell = CellOf(to.x(), to.y(), kCellM);
    CellReturns* returns = &cells[cell];
    if (returns->after.weight == 0.0) returns->before_origin = from;
    returns->after.Add(to.x() - kCellM * cell.first, to.y() - kCellM * cell.second);
    returns->before.Add(from.x() - returns->before_origin.x(),
                        from.y() - returns->before_origin.y());
  }
  return cells;
}

// Differences summed over the blocks of the windows' grid.
std::map<Cell, double> SumBlocks(const std::map<Cell, CellReturns>& cells, double size_m) {
  std::map<Cell, double> blocks;
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
std::map<Cell, double> SumWindows(const std::map<Cell, double>& blocks) {
  std::map<Cell, double> windows;
  for (const auto& [block, difference] : blocks) {
    for (int dx = 0; dx < kBlocksPerWindow; ++dx) {
      for (int dy = 0; dy < kBlocksPerWindow; ++dy) {
        windows[{block.first - dx, block.second - dy}] += difference;
      }
    }
  }
  return windows;
}

}  // namespace

std::vector<MapWindow> ChooseDetails(const std::vector<double>& before,
                                     const std::vector<double>& after, int count, double size_m) {
  std::map<Cell, double> windows = SumWindows(SumBlocks(CollectCells(before, after), size_m));
  std::vector<MapWindow> chosen;
  while (static_cast<int>(chosen.size()) < count && !windows.empty()) {
    const auto best =
        std::max_element(windows.begin(), windows.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    const Cell at = best->first;
    const double block_m = size_m / kBlocksPerWindow;
    chosen.push_back(
        {{at.first * block_m + 0.5 * size_m, at.second * block_m + 0.5 * size_m}, size_m, size_m});
    for (auto it = windows.begin(); it != windows.end();) {
      const bool overlaps = std::abs(it->first.first - at.first) < kBlocksPerWindow &&
                            std::abs(it->first.second - at.second) < kBlocksPerWindow;
      it = overlaps ? windows.erase(it) : std::next(it);
    }
  }
  return chosen;
}

}  // namespace plumbline
