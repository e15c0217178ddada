#include "plumbline/apps/evaluation/session_changes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

namespace plumbline {
namespace {

constexpr double kMinSizeM = 0.3;  // legs of chairs and of people are not worth a word
// Cells of one change are at most this many columns and rows from each other.
constexpr int kReach = 2;

// What change_of_cell_ holds but for numbers of changes.
constexpr int kUnchanged = -1, kUnassigned = -2;

class ChangeSearch {
 public:
  ChangeSearch(const SlamGraph& graph, const MapState& state,
               const std::vector<SessionMark>& sessions)
      : graph_(graph), state_(state), sessions_(sessions) {}

  Status Run(const OccupancyGridOptions& options, std::vector<SessionChange>* changes) {
    grids_.resize(sessions_.size());
    for (std::size_t i = 0; i < sessions_.size(); ++i) {
      PLUMBLINE_RETURN_IF_ERROR(BuildOccupancyGrid(graph_, state_, sessions_[i].first_scan,
                                                   sessions_[i].num_scans, options, &grids_[i]));
    }
    changes->clear();
    for (std::size_t i = 0; i < sessions_.size(); ++i) {
      std::vector<SessionChange> of_session = ChangesShownBy(static_cast<int>(i));
      std::move(of_session.begin(), of_session.end(), std::back_inserter(*changes));
    }
    return Status::Ok();
  }

 private:
  // Free, and nothing occupied next to it: walls move by a cell from one session to the next.
  static bool LooksThrough(const OccupancyGrid& grid, int column, int row) {
    if (grid.At(column, row) != Occupancy::kFree) return false;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.height - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.width - 1); ++x) {
        if (grid.At(x, y) == Occupancy::kOccupied) return false;
      }
    }
    return true;
  }

  bool AnotherLooksThrough(int session, int column, int row) const {
    for (std::size_t other = 0; other < grids_.size(); ++other) {
      if (static_cast<int>(other) == session) continue;
      if (LooksThrough(grids_[other], column, row)) return true;
    }
    return false;
  }

  std::vector<SessionChange> ChangesShownBy(int session) {
    const OccupancyGrid& grid = grids_[session];
    change_of_cell_.assign(grid.cells.size(), kUnchanged);
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) {
        if (grid.At(column, row) == Occupancy::kOccupied &&
            AnotherLooksThrough(session, column, row)) {
          change_of_cell_[Index(column, row)] = kUnassigned;
        }
      }
    }
    std::vector<SessionChange> changes;
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) {
        if (change_of_cell_[Index(column, row)] != kUnassigned) continue;
        changes.push_back(Grow(session, column, row, static_cast<int>(changes.size())));
      }
    }
    AddPoints(session, &changes);
    changes.erase(std::remove_if(changes.begin(), changes.end(),
                                 [](const SessionChange& change) {
                                   return change.size_m < kMinSizeM || change.points.empty();
                                 }),
                  changes.end());
    std::stable_sort(
        changes.begin(), changes.end(),
        [](const SessionChange& a, const SessionChange& b) { return a.size_m > b.size_m; });
    return changes;
  }

  // The change that a cell belongs to, all of whose cells get its number.
  SessionChange Grow(int session, int column, int row, int number) {
    const OccupancyGrid& grid = grids_[session];
    std::vector<std::pair<int, int>> open = {{column, row}};
    change_of_cell_[Index(column, row)] = number;
    int left = column, right = column, bottom = row, top = row;
    SessionChange change;
    change.shown_by = session;
    std::vector<bool> looked_through(grids_.size(), false);
    while (!open.empty()) {
      const auto [x, y] = open.back();
      open.pop_back();
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
      for (std::size_t other = 0; other < grids_.size(); ++other) {
        if (static_cast<int>(other) == session || !LooksThrough(grids_[other], x, y)) continue;
        looked_through[other] = true;
      }
      for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, grid.height - 1); ++v) {
        for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, grid.width - 1); ++u) {
          if (change_of_cell_[Index(u, v)] != kUnassigned) continue;
          change_of_cell_[Index(u, v)] = number;
          open.emplace_back(u, v);
        }
      }
    }
    for (std::size_t other = 0; other < grids_.size(); ++other) {
      if (looked_through[other]) change.looked_through_by.push_back(static_cast<int>(other));
    }
    change.center = {grid.left_m + 0.5 * (left + right + 1) * grid.resolution_m,
                     grid.bottom_m + 0.5 * (bottom + top + 1) * grid.resolution_m};
    change.size_m = std::max(right - left + 1, top - bottom + 1) * grid.resolution_m;
    return change;
  }

  void AddPoints(int session, std::vector<SessionChange>* changes) const {
    const OccupancyGrid& grid = grids_[session];
    const SessionMark& mark = sessions_[session];
    const ScanEntry& last = graph_.scan(mark.first_scan + mark.num_scans - 1);
    for (std::size_t i = graph_.scan(mark.first_scan).first_return;
         i < last.first_return + last.num_returns; ++i) {
      const Eigen::Vector2d point(state_.points[2 * i], state_.points[2 * i + 1]);
      const double column = std::floor((point.x() - grid.left_m) / grid.resolution_m);
      const double row = std::floor((point.y() - grid.bottom_m) / grid.resolution_m);
      if (!(column >= 0.0 && column < grid.width && row >= 0.0 && row < grid.height)) continue;
      const int change = change_of_cell_[Index(static_cast<int>(column), static_cast<int>(row))];
      if (change >= 0) (*changes)[change].points.push_back(point);
    }
  }

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * grids_.front().width + column;
  }

  const SlamGraph& graph_;
  const MapState& state_;
  const std::vector<SessionMark>& sessions_;
  std::vector<OccupancyGrid> grids_;  // per session, all of the same cells
  std::vector<int> change_of_cell_;   // of the session that is looked at
};

}  // namespace

Status FindSessionChanges(const SlamGraph& graph, const MapState& state,
                          const std::vector<SessionMark>& sessions,
                          const OccupancyGridOptions& options,
                          std::vector<SessionChange>* changes) {
  return ChangeSearch(graph, state, sessions).Run(options, changes);
}

}  // namespace plumbline
