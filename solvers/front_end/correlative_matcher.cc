#include "plumbline/solvers/front_end/correlative_matcher.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// More levels would save no more time.
constexpr int kMaxLevel = 5;
constexpr int kKernelCells = 2;
constexpr int kKernelSide = 2 * kKernelCells + 1;
// Points of a scan that are scored: more do not change the ranking of poses.
constexpr std::size_t kMaxScoredPoints = 200;
// Parts of the scan in which a block is scored, each every fourth of its points: the first ones
// often show that the block is no use.
constexpr int kParts = 4;
// Blocks that a search may split, which takes about 0.1 s. Where a scan fits somewhere, a hundredth
// is enough; to prove that bushes and fences fit nowhere takes ten times as many.
constexpr int kMaxSplits = 100000;
// Least difference of two scores, a step of the likelihood grid: along a bare corridor thousands of
// poses fit alike.
constexpr double kScoreResolution = 1.0 / 255.0;

struct Candidate {
  int heading = 0;
  int x = 0;  // shift of the scan in cells, the lowest of the 2^level in its block
  int y = 0;
  // Sums of the likelihoods in the parts of the scan up to each one; of all parts, `score`.
  std::array<int, kParts> sums{};
  double score = 0.0;
};

// Order by score, then heading nearest to the middle, then lowest shift.
bool Precedes(const Candidate& a, const Candidate& b) {
  return std::tie(b.score, a.heading, a.y, a.x) < std::tie(a.score, b.heading, b.y, b.x);
}

// The coarsest level whose blocks fit into a window of that many cells to either side.
int TopLevel(int half_cells) {
  int level = 0;
  while (level < kMaxLevel && (1 << level) <= half_cells) ++level;
  return level;
}

// Samples a Gaussian at kKernelSide cells, the first of which is at `first` standard deviations.
void SampleGaussian(double first, double peak, double* samples) {
  for (int i = 0; i < kKernelSide; ++i) {
    samples[i] = peak * std::exp(-0.5 * (first + i) * (first + i));
  }
}

}  // namespace

// One search, best block first over all headings, so that bounds tighten early.
class BranchAndBound {
 public:
  BranchAndBound(const CorrelativeMatcher& matcher, const SurfacePoints& scan,
                 const SearchWindow& window, double min_score)
      : matcher_(matcher), window_(window), bar_(min_score) {
    const std::size_t stride = (scan.size() + kMaxScoredPoints - 1) / kMaxScoredPoints;
    for (std::size_t i = 0; i < scan.size(); i += stride) points_.push_back(scan[i].position);
    half_cells_ = static_cast<int>(std::ceil(window.half_width_m / matcher.cell_m_));
  }

  // Looks for several peaks.
  void SearchPeaks(int max_peaks, const PeakSize& size) {
    max_peaks_ = static_cast<std::size_t>(max_peaks);
    peak_size_ = size;
  }

  // The best pose, if there is one.
  CorrelativeMatch Run() {
    RunAll();
    CorrelativeMatch best;
    if (!peaks_.empty()) best = peaks_.front();
    best.gave_up = GaveUp();
    return best;
  }

  // The best first.
  std::vector<CorrelativeMatch> RunAll() {
    if (points_.empty() || matcher_.levels_.empty()) return {};
    double sum = 0.0;
    for (const Eigen::Vector2d& point : points_) sum += point.squaredNorm();
    const double lever_m = std::sqrt(sum / static_cast<double>(points_.size()));
    const double step_rad = matcher_.cell_m_ / std::max(lever_m, matcher_.cell_m_);
    const int steps = static_cast<int>(std::ceil(std::min(window_.half_angle_rad, kPi) / step_rad));
    const int level =
        std::min(TopLevel(half_cells_), static_cast<int>(matcher_.levels_.size()) - 1);
    // Two shifts, one of which would bring the point into the map, and on to the next quarter.
    reach_ = 2 * half_cells_ + (1 << level);
    columns_ = EdgedOffsets(matcher_.width_, 1);
    rows_ = EdgedOffsets(matcher_.height_, matcher_.width_);
    std::vector<Candidate> top;
    // From the middle outwards: of equal scores the one nearest to the prediction is taken.
    for (int k = 0; k <= 2 * steps; ++k) {
      const int offset = (k & 1) != 0 ? (k + 1) / 2 : -(k / 2);
      AddHeading(window_.center.yaw + offset * step_rad);
      AddBlocks(level, &top);
    }
    Descend(level, &top);
    for (CorrelativeMatch& peak : peaks_) peak.gave_up = GaveUp();
    return peaks_;
  }

 private:
  bool GaveUp() const { return num_splits_ > kMaxSplits; }

  // The offsets in the grid of its columns or rows, from reach_ before the first one. The empty
  // ones at the edges of the grid stand for all beyond it.
  std::vector<std::ptrdiff_t> EdgedOffsets(int num_lines, int stride) const {
    std::vector<std::ptrdiff_t> offsets(num_lines + 2 * reach_);
    for (int i = 0; i < num_lines + 2 * reach_; ++i) {
      offsets[i] = static_cast<std::ptrdiff_t>(stride) * std::clamp(i - reach_, 0, num_lines - 1);
    }
    return offsets;
  }

  // The scan's points that a shift within the window can bring into the map, unshifted.
  struct Heading {
    double yaw_rad = 0.0;
    std::vector<Eigen::Vector2i> cells;   // part by part
    std::vector<std::ptrdiff_t> offsets;  // of the cells in the grid
    std::array<std::size_t, kParts> part_end{};
    Eigen::Vector2i low, high;  // of the cells
  };

  void AddHeading(double yaw_rad) {
    Heading heading;
    heading.yaw_rad = yaw_rad;
    const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(yaw_rad).toRotationMatrix();
    heading.low.setConstant(std::numeric_limits<int>::max());
    heading.high = -heading.low;
    heading.cells.reserve(points_.size());
    heading.offsets.reserve(points_.size());
    const Eigen::Array2i lowest = matcher_.map_low_.array() - half_cells_;
    const Eigen::Array2i highest = matcher_.map_high_.array() + half_cells_;
    for (std::size_t part = 0; part < kParts; ++part) {
      for (std::size_t i = part; i < points_.size(); i += kParts) {
        const Eigen::Vector2d at =
            (rotation * points_[i] + window_.center.translation() - matcher_.origin_) /
            matcher_.cell_m_;
        const Eigen::Vector2i cell(static_cast<int>(std::floor(at.x())),
                                   static_cast<int>(std::floor(at.y())));
        if ((cell.array() < lowest).any() || (cell.array() > highest).any()) continue;
        heading.cells.push_back(cell);
        heading.offsets.push_back(OffsetOf(cell.x(), cell.y()));
        heading.low = heading.low.cwiseMin(cell);
        heading.high = heading.high.cwiseMax(cell);
      }
      heading.part_end[part] = heading.cells.size();
    }
    headings_.push_back(std::move(heading));
  }

  // The blocks of the last heading, of `level`.
  void AddBlocks(int level, std::vector<Candidate>* top) const {
    const Heading& heading = headings_.back();
    if (heading.cells.empty()) return;
    // Shifts that leave the scan outside the map score nothing, however wide the window.
    const int x_low = std::max(-half_cells_, matcher_.map_low_.x() - heading.high.x());
    const int y_low = std::max(-half_cells_, matcher_.map_low_.y() - heading.high.y());
    const int x_high = std::min(half_cells_, matcher_.map_high_.x() - heading.low.x());
    const int y_high = std::min(half_cells_, matcher_.map_high_.y() - heading.low.y());
    const int side = 2 << level;
    Candidate whole;  // four blocks, of which nothing is known
    whole.heading = static_cast<int>(headings_.size()) - 1;
    for (int part = 0; part < kParts; ++part) {
      whole.sums[part] = 255 * static_cast<int>(heading.part_end[part]);
    }
    for (int y = y_low; y <= y_high; y += side) {
      for (int x = x_low; x <= x_high; x += side) {
        whole.x = x;
        whole.y = y;
        Split(whole, level, top);
      }
    }
  }

  // Sorts the candidates. Returns true if the search is over.
  bool Descend(int level, std::vector<Candidate>* candidates) {
    std::sort(candidates->begin(), candidates->end(), Precedes);
    for (const Candidate& candidate : *candidates) {
      if (candidate.score <= bar_ + kScoreResolution) return false;
      if (IsOfHigherPeak(candidate, level)) continue;
      if (level == 0) {
        Take({true, false, PoseOf(candidate), candidate.score});
        continue;
      }
      ++num_splits_;
      if (GaveUp()) return true;
      std::vector<Candidate>& children = children_[level - 1];
      children.clear();
      Split(candidate, level - 1, &children);
      if (Descend(level - 1, &children)) return true;
    }
    return false;
  }

  // Cuts a block into four of `level` and appends those that begin within the window, scored by
  // their bounds; none if it shows early that none is better than the best pose so far.
  void Split(const Candidate& block, int level, std::vector<Candidate>* parts) const {
    const int side = 1 << level;
    std::array<Candidate, 4> quarters;
    for (int i = 0; i < 4; ++i) {
      quarters[i].heading = block.heading;
      quarters[i].x = block.x + (i & 1) * side;
      quarters[i].y = block.y + (i >> 1) * side;
    }
    std::array<int, 4> sums{};
    for (int part = 0; part < kParts; ++part) {
      AddPart(block, level, part, &sums);
      const int rest = block.sums.back() - block.sums[part];  // bounds what the four can add to it
      const int bound = *std::max_element(sums.begin(), sums.end()) + rest;
      if (ScoreOf(bound) <= bar_ + kScoreResolution) return;
      for (int i = 0; i < 4; ++i) quarters[i].sums[part] = sums[i];
    }
    for (Candidate& quarter : quarters) {
      if (quarter.x > half_cells_ || quarter.y > half_cells_) continue;
      quarter.score = ScoreOf(quarter.sums.back());
      parts->push_back(quarter);
    }
  }

  // Adds the likelihoods of one part of the scan in the four quarters of a block, which are of
  // `level`.
  void AddPart(const Candidate& block, int level, int part, std::array<int, 4>* sums) const {
    const std::uint8_t* grid = matcher_.levels_[level].data();
    const Heading& heading = headings_[block.heading];
    const int side = 1 << level, last_x = matcher_.width_ - 1, last_y = matcher_.height_ - 1;
    const std::size_t first = part == 0 ? 0 : heading.part_end[part - 1];
    const std::size_t end = heading.part_end[part];
    std::array<int, 4> sum = *sums;
    if (heading.low.x() + block.x >= 0 && heading.high.x() + block.x + side <= last_x &&
        heading.low.y() + block.y >= 0 && heading.high.y() + block.y + side <= last_y) {
      const std::ptrdiff_t shift = OffsetOf(block.x, block.y), up = OffsetOf(0, side);
      for (std::size_t c = first; c < end; ++c) {
        const std::uint8_t* lower = grid + shift + heading.offsets[c];
        const std::uint8_t* upper = lower + up;
        sum[0] += lower[0];
        sum[1] += lower[side];
        sum[2] += upper[0];
        sum[3] += upper[side];
      }
    } else {
      const std::ptrdiff_t* columns = columns_.data() + reach_ + block.x;
      const std::ptrdiff_t* rows = rows_.data() + reach_ + block.y;
      for (std::size_t c = first; c < end; ++c) {
        const std::ptrdiff_t* column = columns + heading.cells[c].x();
        const std::ptrdiff_t* row = rows + heading.cells[c].y();
        const std::uint8_t* lower = grid + row[0];
        const std::uint8_t* upper = grid + row[side];
        sum[0] += lower[column[0]];
        sum[1] += lower[column[side]];
        sum[2] += upper[column[0]];
        sum[3] += upper[column[side]];
      }
    }
    *sums = sum;
  }

  // Of a cell in the matcher's grid.
  std::ptrdiff_t OffsetOf(int x, int y) const {
    return static_cast<std::ptrdiff_t>(y) * matcher_.width_ + x;
  }

  double ScoreOf(int sum) const { return sum / (255.0 * static_cast<double>(points_.size())); }

  Pose2 PoseOf(const Candidate& candidate) const {
    return {window_.center.x + candidate.x * matcher_.cell_m_,
            window_.center.y + candidate.y * matcher_.cell_m_,
            headings_[candidate.heading].yaw_rad};
  }

  // A pose that is better than the bar: the best one of its peak so far, or of a peak of its own.
  void Take(const CorrelativeMatch& match) {
    const auto of_this = std::remove_if(peaks_.begin(), peaks_.end(), [&](const auto& peak) {
      return IsSameHeading(match.map_from_scan.yaw, peak.map_from_scan.yaw) &&
             (match.map_from_scan.translation() - peak.map_from_scan.translation()).norm() <=
                 peak_size_.radius_m;
    });
    peaks_.erase(of_this, peaks_.end());
    const auto worse = std::find_if(peaks_.begin(), peaks_.end(),
                                    [&](const auto& peak) { return peak.score < match.score; });
    peaks_.insert(worse, match);
    if (peaks_.size() > max_peaks_) peaks_.pop_back();
    if (peaks_.size() == max_peaks_) bar_ = std::max(bar_, peaks_.back().score);
  }

  bool IsSameHeading(double a_rad, double b_rad) const {
    return std::abs(NormalizeAngle(a_rad - b_rad)) <= peak_size_.angle_rad;
  }

  // Whether all poses of a block are of a peak that has a better one.
  bool IsOfHigherPeak(const Candidate& candidate, int level) const {
    return max_peaks_ > 1 && std::any_of(peaks_.begin(), peaks_.end(), [&](const auto& peak) {
             return candidate.score <= peak.score + kScoreResolution &&
                    IsSameHeading(headings_[candidate.heading].yaw_rad, peak.map_from_scan.yaw) &&
                    IsNear(peak.map_from_scan.translation(), candidate, level);
           });
  }

  // Whether all of a block lies within a peak's radius of a position.
  bool IsNear(const Eigen::Vector2d& position, const Candidate& candidate, int level) const {
    const double side_m = ((1 << level) - 1) * matcher_.cell_m_;
    const Eigen::Vector2d low = PoseOf(candidate).translation() - position;
    const Eigen::Vector2d farthest =
        low.cwiseAbs().cwiseMax((low.array() + side_m).matrix().cwiseAbs());
    return farthest.norm() <= peak_size_.radius_m;
  }

  const CorrelativeMatcher& matcher_;
  const SearchWindow window_;
  std::vector<Eigen::Vector2d> points_;
  int half_cells_ = 0;
  PeakSize peak_size_;
  std::size_t max_peaks_ = 1;
  double bar_;  // what a pose must score to be of interest
  int num_splits_ = 0;

  int reach_ = 0;  // of a block, off the grid, in cells
  std::vector<std::ptrdiff_t> columns_, rows_;
  std::vector<Heading> headings_;
  std::array<std::vector<Candidate>, kMaxLevel> children_;  // per level those being looked through
  std::vector<CorrelativeMatch> peaks_;  // the best pose of each, the best peak first
};

CorrelativeMatcher::CorrelativeMatcher(const SurfacePoints& map, double cell_m, double half_width_m)
    : cell_m_(cell_m) {
  if (map.empty()) return;
  Eigen::Vector2d low = map.front().position, high = low;
  for (const SurfacePoint& point : map) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  const int top_level = TopLevel(static_cast<int>(std::ceil(half_width_m / cell_m)));
  // Blocks of the top level that begin below the map still reach into it.
  const int margin = (1 << top_level) + kKernelCells;
  map_low_.setConstant(1 << top_level);
  origin_ = low.array() - margin * cell_m_;
  width_ = static_cast<int>((high.x() - low.x()) / cell_m_) + 1 + 2 * margin;
  height_ = static_cast<int>((high.y() - low.y()) / cell_m_) + 1 + 2 * margin;
  map_high_ = Eigen::Vector2i(width_ - 1, height_ - 1) - map_low_;
  levels_.assign(top_level + 1, Level(static_cast<std::size_t>(width_) * height_, 0));
  for (const SurfacePoint& point : map) Splat(point.position);
  for (int level = 1; level <= top_level; ++level) Coarsen(level);
}

void CorrelativeMatcher::Splat(const Eigen::Vector2d& point) {
  const Eigen::Vector2d at = (point - origin_) / cell_m_;
  const int x_low = static_cast<int>(at.x()) - kKernelCells;
  const int y_low = static_cast<int>(at.y()) - kKernelCells;
  // The Gaussian is the product of its two axes.
  double along_x[kKernelSide], along_y[kKernelSide];
  SampleGaussian(x_low + 0.5 - at.x(), 1.0, along_x);
  SampleGaussian(y_low + 0.5 - at.y(), 255.0, along_y);
  for (int y = 0; y < kKernelSide; ++y) {
    std::uint8_t* row = &levels_[0][static_cast<std::size_t>(y_low + y) * width_ + x_low];
    for (int x = 0; x < kKernelSide; ++x) {
      // Never negative, where adding 0.5 would be wrong; std::lround is a call per cell.
      // NOLINTNEXTLINE(bugprone-incorrect-roundings)
      row[x] = std::max(row[x], static_cast<std::uint8_t>(along_x[x] * along_y[y] + 0.5));
    }
  }
}

void CorrelativeMatcher::Coarsen(int level) {
  const std::size_t right = std::size_t{1} << (level - 1);
  const std::size_t up = right * static_cast<std::size_t>(width_);
  // Over plain arrays, which the compiler vectorises. The margin is wider than the blocks: what is
  // cut off at the edges is empty.
  const std::uint8_t* finer = levels_[level - 1].data();
  std::uint8_t* coarser = levels_[level].data();
  const std::size_t size = levels_[level].size() - up - right;
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint8_t lower = std::max(finer[i], finer[i + right]);
    const std::uint8_t upper = std::max(finer[i + up], finer[i + up + right]);
    coarser[i] = std::max(lower, upper);
  }
}

CorrelativeMatch CorrelativeMatcher::Search(const SurfacePoints& scan, const SearchWindow& window,
                                            double min_score) const {
  return BranchAndBound(*this, scan, window, min_score).Run();
}

std::vector<CorrelativeMatch> CorrelativeMatcher::SearchPeaks(const SurfacePoints& scan,
                                                              const SearchWindow& window,
                                                              double min_score, int max_peaks,
                                                              const PeakSize& size) const {
  BranchAndBound search(*this, scan, window, min_score);
  search.SearchPeaks(max_peaks, size);
  return search.RunAll();
}

}  // namespace plumbline
