#include "plumbline/apps/evaluation/session_changes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/share_graph.h"

namespace plumbline {
namespace {

constexpr double kMinSizeM = 0.3;  // legs of chairs and of people are not worth a word
// Cells of one change are at most this many columns and rows from each other.
constexpr int kReach = 2;
constexpr int kNone = -1;

// What the occupancy grid of a session says of a cell, two bits in place of its byte: there may be
// many sessions.
struct SessionCells {
  std::vector<bool> is_occupied;
  /// Free, and nothing occupied next to it: walls move by a cell from one session to the next.
  std::vector<bool> is_looked_through;
};

bool LooksThrough(const OccupancyGrid& grid, int column, int row) {
  if (grid.At(column, row) != Occupancy::kFree) return false;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.height - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.width - 1); ++x) {
      if (grid.At(x, y) == Occupancy::kOccupied) return false;
    }
  }
  return true;
}

SessionCells CellsOf(const OccupancyGrid& grid) {
  SessionCells cells;
  cells.is_occupied.reserve(grid.cells.size());
  cells.is_looked_through.reserve(grid.cells.size());
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      cells.is_occupied.push_back(grid.At(column, row) == Occupancy::kOccupied);
      cells.is_looked_through.push_back(LooksThrough(grid, column, row));
    }
  }
  return cells;
}

class ChangeSearch {
 public:
  ChangeSearch(const SlamGraph& graph, const MapState& state,
               const std::vector<SessionMark>& sessions)
      : graph_(graph), state_(state), sessions_(sessions) {}

  Status Run(const OccupancyGridOptions& options, std::vector<SessionChange>* changes) {
    for (const SessionMark& session : sessions_) {
      PLUMBLINE_RETURN_IF_ERROR(BuildOccupancyGrid(graph_, state_, session.first_scan,
                                                   session.num_scans, options, &grid_));
      cells_.push_back(CellsOf(grid_));
    }
    grid_.cells = std::vector<Occupancy>();
    changes->clear();
    for (std::size_t i = 0; i < sessions_.size(); ++i) {
      std::vector<SessionChange> of_session = ChangesShownBy(static_cast<int>(i));
      std::move(of_session.begin(), of_session.end(), std::back_inserter(*changes));
    }
    return Status::Ok();
  }

 private:
  bool AnotherLooksThrough(int session, std::size_t cell) const {
    for (std::size_t other = 0; other < cells_.size(); ++other) {
      if (static_cast<int>(other) != session && cells_[other].is_looked_through[cell]) return true;
    }
    return false;
  }

  std::vector<SessionChange> ChangesShownBy(int session) {
    changed_cells_.clear();
    const std::vector<bool>& is_occupied = cells_[session].is_occupied;
    for (std::size_t cell = 0; cell < is_occupied.size(); ++cell) {
      if (is_occupied[cell] && AnotherLooksThrough(session, cell)) changed_cells_.push_back(cell);
    }
    change_of_cell_.assign(changed_cells_.size(), kNone);
    std::vector<SessionChange> changes;
    for (std::size_t i = 0; i < changed_cells_.size(); ++i) {
      if (change_of_cell_[i] != kNone) continue;
      changes.push_back(Grow(session, i, static_cast<int>(changes.size())));
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

  // The change that a changed cell belongs to, all of whose cells get its number.
  SessionChange Grow(int session, std::size_t first, int number) {
    std::vector<std::size_t> open = {first};
    change_of_cell_[first] = number;
    int left = grid_.width, right = 0, bottom = grid_.height, top = 0;
    SessionChange change;
    change.shown_by = session;
    std::vector<bool> looked_through(cells_.size(), false);
    while (!open.empty()) {
      const std::size_t cell = changed_cells_[open.back()];
      open.pop_back();
      const int x = static_cast<int>(cell % grid_.width), y = static_cast<int>(cell / grid_.width);
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
      for (std::size_t other = 0; other < cells_.size(); ++other) {
        if (static_cast<int>(other) == session || !cells_[other].is_looked_through[cell]) continue;
        looked_through[other] = true;
      }
      for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, grid_.height - 1); ++v) {
        for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, grid_.width - 1); ++u) {
          const std::size_t near = ChangedCellAt(u, v);
          if (near == changed_cells_.size() || change_of_cell_[near] != kNone) continue;
          change_of_cell_[near] = number;
          open.push_back(near);
        }
      }
    }
    for (std::size_t other = 0; other < cells_.size(); ++other) {
      if (looked_through[other]) change.looked_through_by.push_back(static_cast<int>(other));
    }
    change.center = {grid_.left_m + 0.5 * (left + right + 1) * grid_.resolution_m,
                     grid_.bottom_m + 0.5 * (bottom + top + 1) * grid_.resolution_m};
    change.size_m = std::max(right - left + 1, top - bottom + 1) * grid_.resolution_m;
    return change;
  }

  // A point of a change.
  struct Found {
    int change;
    std::size_t return_id;  // among all
    double x, y;
  };

  // In the order of their returns, whichever processes have these.
  void AddPoints(int session, std::vector<SessionChange>* changes) const {
    const SessionMark& mark = sessions_[session];
    std::vector<Found> found;
    const int end = FirstOwnScanFrom(graph_, mark.first_scan + mark.num_scans);
    for (int scan = FirstOwnScanFrom(graph_, mark.first_scan); scan < end; ++scan) {
      const ScanEntry& entry = graph_.scan(scan);
      for (std::size_t r = entry.first_return; r < entry.first_return + entry.num_returns; ++r) {
        const double* point = &state_.points[2 * r];
        const int change = ChangeAt(point[0], point[1]);
        if (change == kNone) continue;
        found.push_back({change, graph_.ReturnIdAmongAll(r), point[0], point[1]});
      }
    }
    found = JoinOverPeers(graph_.peers(), std::move(found));
    std::sort(found.begin(), found.end(),
              [](const Found& a, const Found& b) { return a.return_id < b.return_id; });
    for (const Found& point : found) (*changes)[point.change].points.emplace_back(point.x, point.y);
  }

  // The change that a point of the session that is looked at belongs to, or kNone.
  int ChangeAt(double x, double y) const {
    const double column = std::floor((x - grid_.left_m) / grid_.resolution_m);
    const double row = std::floor((y - grid_.bottom_m) / grid_.resolution_m);
    if (!(column >= 0.0 && column < grid_.width && row >= 0.0 && row < grid_.height)) return kNone;
    const std::size_t cell = ChangedCellAt(static_cast<int>(column), static_cast<int>(row));
    return cell == changed_cells_.size() ? kNone : change_of_cell_[cell];
  }

  // Index among changed_cells_; their number if it is none of them.
  std::size_t ChangedCellAt(int column, int row) const {
    const std::size_t cell = static_cast<std::size_t>(row) * grid_.width + column;
    const auto found = std::lower_bound(changed_cells_.begin(), changed_cells_.end(), cell);
    const bool is_one = found != changed_cells_.end() && *found == cell;
    return is_one ? found - changed_cells_.begin() : changed_cells_.size();
  }

  const SlamGraph& graph_;
  const MapState& state_;
  const std::vector<SessionMark>& sessions_;
  OccupancyGrid grid_;               // where the cells of all sessions are
  std::vector<SessionCells> cells_;  // per session, row by row
  // Of the session that is looked at: cells that another one looks through, in ascending order, and
  // the change that each belongs to.
  std::vector<std::size_t> changed_cells_;
  std::vector<int> change_of_cell_;
};

}  // namespace

Status FindSessionChanges(const SlamGraph& graph, const MapState& state,
                          const std::vector<SessionMark>& sessions,
                          const OccupancyGridOptions& options,
                          std::vector<SessionChange>* changes) {
  return ChangeSearch(graph, state, sessions).Run(options, changes);
}

}  // namespace plumbline
