#include "plumbline/apps/io/occupancy_grid.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "plumbline/apps/io/map_raster.h"
#include "plumbline/apps/io/occupancy_scores.h"
#include "plumbline/core/joined_returns.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/share_graph.h"

namespace plumbline {
namespace {

constexpr double kCropShare = 1e-4;
// Neighbouring beams farther apart than this tell nothing of what is between them: a leg with its
// shoe, or a small robot.
constexpr double kMaxBeamGapM = 0.3;
// A scan that touches a cell weighs as much as this many scans that look through it.
constexpr std::int32_t kTouchWeight = 3;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Adds what scans tell to the scores of a grid: positive where they touch a surface, negative where
// they look through.
class ScanScorer {
 public:
  ScanScorer(const SlamGraph& graph, const MapState& state, const OccupancyGrid& grid,
             OccupancyScores* scores)
      : graph_(graph), state_(state), grid_(grid), scores_(scores) {}

  void Add(int scan) {
    const ScanEntry& entry = graph_.scan(scan);
    points_.resize(entry.num_returns);
    cells_.resize(entry.num_returns);
    for (std::size_t k = 0; k < entry.num_returns; ++k) {
      const double* point = &state_.points[2 * (entry.first_return + k)];
      points_[k] = {point[0], point[1]};
      cells_[k] = InCells(points_[k]);
    }
    AddSurface(scan);
    AddFreeSpace(scan, InCells(graph_.WorldFromLaser(scan, state_.poses).translation()));
  }

 private:
  Eigen::Vector2d InCells(const Eigen::Vector2d& point_in_world) const {
    return (point_in_world - Eigen::Vector2d(grid_.left_m, grid_.bottom_m)) / grid_.resolution_m;
  }

  // Not a number, or too far away to be a place.
  static bool IsPlace(const Eigen::Vector2d& cell) { return cell.cwiseAbs().maxCoeff() < 1e12; }

  bool IsClose(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    return (b - a).norm() * grid_.resolution_m <= kMaxBeamGapM;
  }

  void AddSurface(int scan) {
    FindJoinedReturns(graph_, scan, points_, grid_.resolution_m, &joined_);
    scores_->BeginScan();
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      if (!IsPlace(cells_[k])) continue;
      if (joined_[k] && IsClose(cells_[k - 1], cells_[k])) {
        scores_->AddToLine(cells_[k - 1], cells_[k], kTouchWeight);
      } else {
        scores_->AddToCell(cells_[k], kTouchWeight);
      }
    }
  }

  // One outline around the free triangles between neighbouring beams, from the laser along one
  // triangle after the other and back.
  void AddFreeSpace(int scan, const Eigen::Vector2d& laser) {
    const ScanReturns returns = graph_.ReturnsOfScan(scan);
    const std::size_t first = graph_.scan(scan).first_return;
    const double turn = graph_.LaserOfScan(scan).bearing_step_rad < 0.0 ? -1.0 : 1.0;
    if (!IsPlace(laser)) return;
    Eigen::Vector2d tip = laser;
    for (std::size_t k = 1; k < cells_.size(); ++k) {
      Eigen::Vector2d a = cells_[k - 1] - laser, b = cells_[k] - laser;
      const bool is_gap = returns.Beam(first + k) > returns.Beam(first + k - 1) + 1;
      if (is_gap || !CutToFreePart(turn, &a, &b)) a = b = {0.0, 0.0};
      AddEdge(tip, laser + a, turn);
      AddEdge(laser + a, laser + b, turn);
      tip = laser + b;
    }
    AddEdge(tip, laser, turn);
  }

  // Cuts the triangle between the laser, at the origin, and the ends of two neighbouring beams down
  // to what is free; false if nothing is, also if the ends are not in order. That is what lies
  // before the line through both ends far enough for the line not to touch the cell, where the
  // beams are close, and not far beyond the nearer end, from where on one beam is alone.
  bool CutToFreePart(double turn, Eigen::Vector2d* a, Eigen::Vector2d* b) const {
    const double area = turn * Cross(*a, *b);
    if (!(area > 0.0) || !IsPlace(*a) || !IsPlace(*b)) return false;
    // A line with the normal n touches a cell whose centre is within (|n_x| + |n_y|) / 2 of it; the
    // laser is area / |b - a| away from it.
    const double share = 1.0 - 0.5 * (*b - *a).lpNorm<1>() / area;
    if (share <= 0.0) return false;
    const double gap = kMaxBeamGapM / grid_.resolution_m;
    const double range_a = a->norm(), range_b = b->norm();
    const double limit = std::min(std::min(range_a, range_b) + gap, gap * range_a * range_b / area);
    *a *= std::min(share, limit / range_a);
    *b *= std::min(share, limit / range_b);
    return true;
  }

  void AddEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double turn) {
    if (turn > 0.0) {
      scores_->AddEdge(from, to);
    } else {
      scores_->AddEdge(to, from);
    }
  }

  const SlamGraph& graph_;
  const MapState& state_;
  const OccupancyGrid& grid_;
  OccupancyScores* scores_;
  std::vector<Eigen::Vector2d> points_, cells_;  // of one scan: world frame [m]; in cells
  std::vector<bool> joined_;
};

// The grid's lower left corner and its sides, in cells.
struct GridSides {
  GridSides(const MapExtent& extent, double cell_m)
      : left(std::floor(extent.x.low / cell_m)),
        bottom(std::floor(extent.y.low / cell_m)),
        width(std::ceil(extent.x.high / cell_m) - left),
        height(std::ceil(extent.y.high / cell_m) - bottom) {}
  double left, bottom, width, height;
};

Status LayGrid(const MapExtent& extent, const OccupancyGridOptions& options, OccupancyGrid* grid) {
  double cell_m = options.resolution_m;
  GridSides sides(extent, cell_m);
  while (!(sides.width * sides.height <= options.max_cells)) {
    if (!options.coarsen_to_fit) {
      std::ostringstream message;
      message << "occupancy grid: " << extent.x.length() << " m x " << extent.y.length()
              << " m in cells of " << cell_m << " m are more than " << options.max_cells
              << " cells; a coarser map resolution would do";
      return Status::InvalidArgument(message.str());
    }
    cell_m *= 2.0;
    sides = GridSides(extent, cell_m);
  }
  *grid = {cell_m,
           sides.left * cell_m,
           sides.bottom * cell_m,
           static_cast<int>(sides.width),
           static_cast<int>(sides.height),
           {}};
  return Status::Ok();
}

void Classify(const OccupancyScores& scores, OccupancyGrid* grid) {
  grid->cells.resize(static_cast<std::size_t>(grid->width) * grid->height);
  std::vector<std::int32_t> row;
  for (int y = 0; y < grid->height; ++y) {
    scores.Row(y, &row);
    Occupancy* cells = &grid->cells[static_cast<std::size_t>(y) * grid->width];
    for (int x = 0; x < grid->width; ++x) {
      cells[x] = row[x] > 0   ? Occupancy::kOccupied
                 : row[x] < 0 ? Occupancy::kFree
                              : Occupancy::kUnknown;
    }
  }
}

bool HasOccupiedNeighbour(const OccupancyGrid& grid, int column, int row) {
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.height - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.width - 1); ++x) {
      if ((x != column || y != row) && grid.At(x, y) == Occupancy::kOccupied) return true;
    }
  }
  return false;
}

// A cell that goes had no occupied neighbour, so the order does not matter.
void DropStrayReturns(const OccupancyScores& scores, OccupancyGrid* grid) {
  std::vector<std::int32_t> row;
  for (int y = 0; y < grid->height; ++y) {
    scores.Row(y, &row);
    for (int x = 0; x < grid->width; ++x) {
      if (row[x] <= 0 || row[x] > kTouchWeight || HasOccupiedNeighbour(*grid, x, y)) continue;
      grid->cells[static_cast<std::size_t>(y) * grid->width + x] = Occupancy::kUnknown;
    }
  }
}

Status BuildAt(const SlamGraph& graph, const MapState& state, int first_scan, int num_scans,
               const OccupancyGridOptions& options, int rank, OccupancyGrid* grid) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("occupancy grid options: " + error);
  if (state.poses.empty()) {
    return Status::InvalidArgument("occupancy grid: the graph has no poses");
  }
  for (int pose = 0; pose < state.num_poses(); ++pose) {
    if (IsFinite(state.WorldFromRobot(pose))) continue;
    return Status::InvalidArgument("occupancy grid: pose " + std::to_string(pose) +
                                   " is not finite");
  }
  MapExtent extent;
  PLUMBLINE_RETURN_IF_ERROR(FindExtent(graph, state, kCropShare, &extent));
  OccupancyGrid result;
  PLUMBLINE_RETURN_IF_ERROR(LayGrid(extent, options, &result));
  OccupancyScores scores(result.width, result.height);
  ScanScorer scorer(graph, state, result, &scores);
  const int end = FirstOwnScanFrom(graph, first_scan + num_scans);
  for (int scan = FirstOwnScanFrom(graph, first_scan); scan < end; ++scan) scorer.Add(scan);
  if (scores.AddThoseOf(graph.peers(), rank)) {
    Classify(scores, &result);
    DropStrayReturns(scores, &result);
  }
  *grid = std::move(result);
  return Status::Ok();
}

}  // namespace

bool OccupancyGridOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(resolution_m, 0.001, 100.0);
  PLUMBLINE_CHECK_OPTION(max_cells, >=, 1.0);
  PLUMBLINE_CHECK_OPTION(max_cells, <=, 2e9);  // A side fits into an int.
  return true;
}

Status CheckGridSize(const SlamGraph& graph, const MapState& state,
                     const OccupancyGridOptions& options, double* num_cells) {
  MapExtent extent;
  PLUMBLINE_RETURN_IF_ERROR(FindExtent(graph, state, kCropShare, &extent));
  OccupancyGrid grid;
  PLUMBLINE_RETURN_IF_ERROR(LayGrid(extent, options, &grid));
  if (num_cells != nullptr) *num_cells = static_cast<double>(grid.width) * grid.height;
  return Status::Ok();
}

Status BuildOccupancyGrid(const SlamGraph& graph, const MapState& state,
                          const OccupancyGridOptions& options, OccupancyGrid* grid) {
  const auto num_scans = static_cast<int>(graph.all_scans().size());
  return BuildOccupancyGrid(graph, state, 0, num_scans, options, grid);
}

Status BuildOccupancyGrid(const SlamGraph& graph, const MapState& state, int first_scan,
                          int num_scans, const OccupancyGridOptions& options, OccupancyGrid* grid) {
  return BuildAt(graph, state, first_scan, num_scans, options, OccupancyScores::kEveryRank, grid);
}

Status GatherOccupancyGrid(const SlamGraph& graph, const MapState& state,
                           const OccupancyGridOptions& options, int rank, OccupancyGrid* grid) {
  const auto num_scans = static_cast<int>(graph.all_scans().size());
  return BuildAt(graph, state, 0, num_scans, options, rank, grid);
}

}  // namespace plumbline
