#include "plumbline/solvers/seeding/correlative_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr int kTopLevel = 5;
constexpr int kKernelCells = 2;
// Points of a scan that are scored: more of them change the ranking of poses no longer.
constexpr std::size_t kMaxScoredPoints = 200;

struct Candidate {
  int x = 0;  // shift of the scan in cells, the lowest of the 2^level in its block
  int y = 0;
  double score = 0.0;
};

}  // namespace

// One search: depth first, the most promising block first, so that bounds tighten early.
class BranchAndBound {
 public:
  BranchAndBound(const CorrelativeMatcher& matcher, const SurfacePoints& scan,
                 const SearchWindow& window, double min_score)
      : matcher_(matcher), window_(window) {
    best_.score = min_score;
    const std::size_t stride = (scan.size() + kMaxScoredPoints - 1) / kMaxScoredPoints;
    for (std::size_t i = 0; i < scan.size(); i += stride) points_.push_back(scan[i].position);
    half_cells_ = static_cast<int>(std::ceil(window.half_width_m / matcher.cell_m_));
  }

  void Exclude(const Pose2& pose, double radius_m, double angle_rad) {
    excluded_ = pose;
    excluded_radius_m_ = radius_m;
    excluded_angle_rad_ = angle_rad;
  }

  CorrelativeMatch Run() {
    if (points_.empty() || matcher_.levels_.empty()) return best_;
    double sum = 0.0;
    for (const Eigen::Vector2d& point : points_) sum += point.squaredNorm();
    const double lever_m = std::sqrt(sum / static_cast<double>(points_.size()));
    const double step_rad = matcher_.cell_m_ / std::max(lever_m, matcher_.cell_m_);
    const int steps = static_cast<int>(std::ceil(std::min(window_.half_angle_rad, kPi) / step_rad));
    // From the middle outwards: the prediction is more often right than wrong.
    for (int k = 0; k <= 2 * steps; ++k) {
      SearchHeading(window_.center.yaw + ((k & 1) != 0 ? 1 : -1) * ((k + 1) / 2) * step_rad);
    }
    return best_;
  }

 private:
  void SearchHeading(double yaw_rad) {
    yaw_rad_ = yaw_rad;
    heading_excluded_ = excluded_radius_m_ > 0.0 &&
                        std::abs(NormalizeAngle(yaw_rad - excluded_.yaw)) <= excluded_angle_rad_;
    const Pose2 pose(window_.center.x, window_.center.y, yaw_rad);
    cells_.clear();
    Eigen::Vector2i low(std::numeric_limits<int>::max(), std::numeric_limits<int>::max());
    Eigen::Vector2i high = -low;
    for (const Eigen::Vector2d& point : points_) {
      const Eigen::Vector2d at = (pose * point - matcher_.origin_) / matcher_.cell_m_;
      cells_.emplace_back(static_cast<int>(std::floor(at.x())),
                          static_cast<int>(std::floor(at.y())));
      low = low.cwiseMin(cells_.back());
      high = high.cwiseMax(cells_.back());
    }
    // Shifts that leave the scan outside the grid score nothing, however wide the window.
    const int x_low = std::max(-half_cells_, -high.x());
    const int y_low = std::max(-half_cells_, -high.y());
    const int x_high = std::min(half_cells_, matcher_.width_ - 1 - low.x());
    const int y_high = std::min(half_cells_, matcher_.height_ - 1 - low.y());
    int level = 0;
    while (level < kTopLevel && (1 << level) <= half_cells_) ++level;
    const int size = 1 << level;
    std::vector<Candidate> top;
    for (int y = y_low; y <= y_high; y += size) {
      for (int x = x_low; x <= x_high; x += size) top.push_back({x, y, 0.0});
    }
    Descend(level, &top);
  }

  void Descend(int level, std::vector<Candidate>* candidates) {
    for (Candidate& candidate : *candidates) candidate.score = Bound(candidate, level);
    std::stable_sort(candidates->begin(), candidates->end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    for (const Candidate& candidate : *candidates) {
      if (candidate.score <= best_.score) return;
      if (level == 0) {
        Accept(candidate);
        continue;
      }
      const int half = 1 << (level - 1);
      std::vector<Candidate> children;
      for (const int y : {candidate.y, candidate.y + half}) {
        for (const int x : {candidate.x, candidate.x + half}) {
          if (x <= half_cells_ && y <= half_cells_) children.push_back({x, y, 0.0});
        }
      }
      Descend(level - 1, &children);
    }
  }

  double Bound(const Candidate& candidate, int level) const {
    const std::vector<std::uint8_t>& grid = matcher_.levels_[level];
    int sum = 0;
    for (const Eigen::Vector2i& cell : cells_) {
      const int x = cell.x() + candidate.x, y = cell.y() + candidate.y;
      if (x < 0 || y < 0 || x >= matcher_.width_ || y >= matcher_.height_) continue;
      sum += grid[static_cast<std::size_t>(y) * matcher_.width_ + x];
    }
    return sum / (255.0 * static_cast<double>(cells_.size()));
  }

  void Accept(const Candidate& candidate) {
    const Pose2 pose(window_.center.x + candidate.x * matcher_.cell_m_,
                     window_.center.y + candidate.y * matcher_.cell_m_, yaw_rad_);
    if (heading_excluded_ &&
        (pose.translation() - excluded_.translation()).norm() <= excluded_radius_m_) {
      return;
    }
    best_ = {true, pose, candidate.score};
  }

  const CorrelativeMatcher& matcher_;
  const SearchWindow window_;
  std::vector<Eigen::Vector2d> points_;
  int half_cells_ = 0;
  Pose2 excluded_;
  double excluded_radius_m_ = 0.0;
  double excluded_angle_rad_ = 0.0;

  double yaw_rad_ = 0.0;
  bool heading_excluded_ = false;
  std::vector<Eigen::Vector2i> cells_;  // of the scan at the current heading, unshifted
  CorrelativeMatch best_;
};

CorrelativeMatcher::CorrelativeMatcher(const SurfacePoints& map, double cell_m) : cell_m_(cell_m) {
  if (map.empty()) return;
  Eigen::Vector2d low = map.front().position, high = low;
  for (const SurfacePoint& point : map) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  // Blocks of the top level that begin below the map still reach into it.
  constexpr int kMargin = (1 << kTopLevel) + kKernelCells;
  origin_ = low.array() - kMargin * cell_m_;
  width_ = static_cast<int>((high.x() - low.x()) / cell_m_) + 1 + 2 * kMargin;
  height_ = static_cast<int>((high.y() - low.y()) / cell_m_) + 1 + 2 * kMargin;
  levels_.assign(1, Level(static_cast<std::size_t>(width_) * height_, 0));
  for (const SurfacePoint& point : map) Splat(point.position);
  BuildPyramid();
}

void CorrelativeMatcher::Splat(const Eigen::Vector2d& point) {
  const Eigen::Vector2d at = (point - origin_) / cell_m_;
  const int cx = static_cast<int>(at.x()), cy = static_cast<int>(at.y());
  for (int y = cy - kKernelCells; y <= cy + kKernelCells; ++y) {
    for (int x = cx - kKernelCells; x <= cx + kKernelCells; ++x) {
      const Eigen::Vector2d offset(x + 0.5 - at.x(), y + 0.5 - at.y());
      const auto value =
          static_cast<std::uint8_t>(std::lround(255.0 * std::exp(-0.5 * offset.squaredNorm())));
      std::uint8_t& cell = levels_[0][static_cast<std::size_t>(y) * width_ + x];
      cell = std::max(cell, value);
    }
  }
}

void CorrelativeMatcher::BuildPyramid() {
  for (int level = 1; level <= kTopLevel; ++level) {
    const Level& finer = levels_.back();
    const int half = 1 << (level - 1);
    Level coarser(finer.size());
    for (int y = 0; y < height_; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * width_;
      const std::size_t next = static_cast<std::size_t>(std::min(y + half, height_ - 1)) * width_;
      for (int x = 0; x < width_; ++x) {
        const int right = std::min(x + half, width_ - 1);
        coarser[row + x] = std::max(std::max(finer[row + x], finer[row + right]),
                                    std::max(finer[next + x], finer[next + right]));
      }
    }
    levels_.push_back(std::move(coarser));
  }
}

CorrelativeMatch CorrelativeMatcher::Search(const SurfacePoints& scan, const SearchWindow& window,
                                            double min_score) const {
  return BranchAndBound(*this, scan, window, min_score).Run();
}

CorrelativeMatch CorrelativeMatcher::SearchElsewhere(const SurfacePoints& scan,
                                                     const SearchWindow& window, double min_score,
                                                     const Pose2& excluded, double radius_m,
                                                     double angle_rad) const {
  BranchAndBound search(*this, scan, window, min_score);
  search.Exclude(excluded, radius_m, angle_rad);
  return search.Run();
}

}  // namespace plumbline
