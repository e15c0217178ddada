#include "plumbline/solvers/seeding/correlative_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr int kTopLevel = 5;
constexpr int kKernelCells = 2;
// Points of a scan that are scored: more of them change the ranking of poses no longer.
constexpr std::size_t kMaxScoredPoints = 200;

// A better score must be better by more than this, a step of the likelihood grid: along a bare
// corridor thousands of poses fit alike.
constexpr double kScoreResolution = 1.0 / 255.0;

struct Candidate {
  int heading = 0;
  int x = 0;  // shift of the scan in cells, the lowest of the 2^level in its block
  int y = 0;
  double score = 0.0;
};

bool BetterScore(const Candidate& a, const Candidate& b) { return a.score > b.score; }

}  // namespace

// One search: the most promising block of all headings first, so that bounds tighten early.
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

  // Looks for any pose that is not near this one instead of the best of all.
  void SearchElsewhereThan(const Pose2& pose, double radius_m, double angle_rad) {
    excluded_ = pose;
    excluded_radius_m_ = radius_m;
    excluded_angle_rad_ = angle_rad;
    any_will_do_ = true;
  }

  CorrelativeMatch Run() {
    if (points_.empty() || matcher_.levels_.empty()) return best_;
    double sum = 0.0;
    for (const Eigen::Vector2d& point : points_) sum += point.squaredNorm();
    const double lever_m = std::sqrt(sum / static_cast<double>(points_.size()));
    const double step_rad = matcher_.cell_m_ / std::max(lever_m, matcher_.cell_m_);
    const int steps = static_cast<int>(std::ceil(std::min(window_.half_angle_rad, kPi) / step_rad));
    int level = 0;
    while (level < kTopLevel && (1 << level) <= half_cells_) ++level;
    std::vector<Candidate> top;
    // From the middle outwards: of equal scores the one nearest to the prediction is taken.
    for (int k = 0; k <= 2 * steps; ++k) {
      AddHeading(window_.center.yaw + ((k & 1) != 0 ? 1 : -1) * ((k + 1) / 2) * step_rad, level,
                 &top);
    }
    Descend(level, &top);
    return best_;
  }

 private:
  struct Heading {
    double yaw_rad = 0.0;
    bool excluded = false;
    std::vector<Eigen::Vector2i> cells;  // of the scan, unshifted
  };

  void AddHeading(double yaw_rad, int level, std::vector<Candidate>* top) {
    Heading heading;
    heading.yaw_rad = yaw_rad;
    heading.excluded = excluded_radius_m_ > 0.0 &&
                       std::abs(NormalizeAngle(yaw_rad - excluded_.yaw)) <= excluded_angle_rad_;
    const Pose2 pose(window_.center.x, window_.center.y, yaw_rad);
    Eigen::Vector2i low(std::numeric_limits<int>::max(), std::numeric_limits<int>::max());
    Eigen::Vector2i high = -low;
    for (const Eigen::Vector2d& point : points_) {
      const Eigen::Vector2d at = (pose * point - matcher_.origin_) / matcher_.cell_m_;
      heading.cells.emplace_back(static_cast<int>(std::floor(at.x())),
                                 static_cast<int>(std::floor(at.y())));
      low = low.cwiseMin(heading.cells.back());
      high = high.cwiseMax(heading.cells.back());
    }
    headings_.push_back(std::move(heading));
    // Shifts that leave the scan outside the grid score nothing, however wide the window.
    const int x_low = std::max(-half_cells_, -high.x());
    const int y_low = std::max(-half_cells_, -high.y());
    const int x_high = std::min(half_cells_, matcher_.width_ - 1 - low.x());
    const int y_high = std::min(half_cells_, matcher_.height_ - 1 - low.y());
    const int id = static_cast<int>(headings_.size()) - 1;
    for (int y = y_low; y <= y_high; y += 1 << level) {
      for (int x = x_low; x <= x_high; x += 1 << level) top->push_back({id, x, y, 0.0});
    }
  }

  // Returns true if the search is over.
  bool Descend(int level, std::vector<Candidate>* candidates) {
    for (Candidate& candidate : *candidates) candidate.score = Bound(candidate, level);
    std::stable_sort(candidates->begin(), candidates->end(), BetterScore);
    for (const Candidate& candidate : *candidates) {
      if (candidate.score <= best_.score + kScoreResolution) return false;
      if (IsExcluded(candidate, level)) continue;
      if (level == 0) {
        best_ = {true, PoseOf(candidate), candidate.score};
        if (any_will_do_) return true;
        continue;
      }
      const int half = 1 << (level - 1);
      std::vector<Candidate> children;
      for (const int y : {candidate.y, candidate.y + half}) {
        for (const int x : {candidate.x, candidate.x + half}) {
          if (x <= half_cells_ && y <= half_cells_) {
            children.push_back({candidate.heading, x, y, 0.0});
          }
        }
      }
      if (Descend(level - 1, &children)) return true;
    }
    return false;
  }

  double Bound(const Candidate& candidate, int level) const {
    const std::vector<std::uint8_t>& grid = matcher_.levels_[level];
    const std::vector<Eigen::Vector2i>& cells = headings_[candidate.heading].cells;
    int sum = 0;
    for (const Eigen::Vector2i& cell : cells) {
      const int x = cell.x() + candidate.x, y = cell.y() + candidate.y;
      if (x < 0 || y < 0 || x >= matcher_.width_ || y >= matcher_.height_) continue;
      sum += grid[static_cast<std::size_t>(y) * matcher_.width_ + x];
    }
    return sum / (255.0 * static_cast<double>(cells.size()));
  }

  Pose2 PoseOf(const Candidate& candidate) const {
    return {window_.center.x + candidate.x * matcher_.cell_m_,
            window_.center.y + candidate.y * matcher_.cell_m_,
            headings_[candidate.heading].yaw_rad};
  }

  // Whether all poses of a block are near the excluded one.
  bool IsExcluded(const Candidate& candidate, int level) const {
    if (!headings_[candidate.heading].excluded) return false;
    const double side_m = ((1 << level) - 1) * matcher_.cell_m_;
    const Eigen::Vector2d low = PoseOf(candidate).translation() - excluded_.translation();
    const Eigen::Vector2d farthest =
        low.cwiseAbs().cwiseMax((low.array() + side_m).matrix().cwiseAbs());
    return farthest.norm() <= excluded_radius_m_;
  }

  const CorrelativeMatcher& matcher_;
  const SearchWindow window_;
  std::vector<Eigen::Vector2d> points_;
  int half_cells_ = 0;
  Pose2 excluded_;
  double excluded_radius_m_ = 0.0;
  double excluded_angle_rad_ = 0.0;
  bool any_will_do_ = false;

  std::vector<Heading> headings_;
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
  constexpr int kSide = 2 * kKernelCells + 1;
  const Eigen::Vector2d at = (point - origin_) / cell_m_;
  const int x_low = static_cast<int>(at.x()) - kKernelCells;
  const int y_low = static_cast<int>(at.y()) - kKernelCells;
  // The Gaussian is the product of its two axes.
  double along_x[kSide], along_y[kSide];
  for (int i = 0; i < kSide; ++i) {
    const double dx = x_low + i + 0.5 - at.x(), dy = y_low + i + 0.5 - at.y();
    along_x[i] = std::exp(-0.5 * dx * dx);
    along_y[i] = 255.0 * std::exp(-0.5 * dy * dy);
  }
  for (int y = 0; y < kSide; ++y) {
    std::uint8_t* row = &levels_[0][static_cast<std::size_t>(y_low + y) * width_ + x_low];
    for (int x = 0; x < kSide; ++x) {
      row[x] = std::max(row[x], static_cast<std::uint8_t>(along_x[x] * along_y[y] + 0.5));
    }
  }
}

void CorrelativeMatcher::BuildPyramid() {
  const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  for (int level = 1; level <= kTopLevel; ++level) {
    const Level& finer = levels_.back();
    const std::size_t half = std::size_t{1} << (level - 1);
    // First to the right, then upwards, in plain loops that the compiler vectorises. The margin is
    // wider than the blocks: what is cut off at the edges is empty.
    Level rows = finer;
    for (std::size_t i = 0; i + half < rows.size(); ++i) {
      rows[i] = std::max(finer[i], finer[i + half]);
    }
    Level coarser = rows;
    for (std::size_t i = 0; i + half * width < height * width; ++i) {
      coarser[i] = std::max(rows[i], rows[i + half * width]);
    }
    levels_.push_back(std::move(coarser));
  }
}

CorrelativeMatch CorrelativeMatcher::Search(const SurfacePoints& scan, const SearchWindow& window,
                                            double min_score) const {
  return BranchAndBound(*this, scan, window, min_score).Run();
}

bool CorrelativeMatcher::FitsElsewhere(const SurfacePoints& scan, const SearchWindow& window,
                                       double min_score, const Pose2& excluded, double radius_m,
                                       double angle_rad) const {
  BranchAndBound search(*this, scan, window, min_score);
  search.SearchElsewhereThan(excluded, radius_m, angle_rad);
  return search.Run().found;
}

}  // namespace plumbline
