#include "plumbline/apps/io/occupancy_scores.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "plumbline/core/over_peers.h"

namespace plumbline {
namespace {

std::int64_t CellOf(double coordinate) { return static_cast<std::int64_t>(std::floor(coordinate)); }

// The first cell along one axis whose centre lies behind the coordinate, cut off at [0, size].
int FirstCentre(double coordinate, int size) {
  return static_cast<int>(std::min(std::max(coordinate + 0.5, 0.0), static_cast<double>(size)));
}

// How far along a line, in shares of its length, the borders of cells lie that it crosses.
struct Crossings {
  Crossings(double from, double length, std::int64_t cell)
      : direction(length < 0.0 ? -1 : 1),
        next((cell + (length < 0.0 ? 0.0 : 1.0) - from) / length),
        step(direction / length) {}

  const int direction;
  double next, step;
};

}  // namespace

OccupancyScores::OccupancyScores(int width, int height)
    : width_(width),
      height_(height),
      blocks_per_row_(width / kBlockSide + 1),
      blocks_(blocks_per_row_ * (height / kBlockSide + 1)) {
  BeginScan();
}

void OccupancyScores::Add(std::int64_t x, std::int64_t y, std::int32_t amount) {
  if (x < 0 || x >= width_ || y < 0 || y >= height_) return;
  const std::size_t cell = static_cast<std::size_t>(y) * width_ + x;
  if (std::find(recent_.begin(), recent_.end(), cell) != recent_.end()) return;
  recent_[num_added_++ % recent_.size()] = cell;
  Difference(static_cast<int>(x), static_cast<int>(y)) += amount;
  Difference(static_cast<int>(x) + 1, static_cast<int>(y)) -= amount;
}

void OccupancyScores::AddToCell(const Eigen::Vector2d& point, std::int32_t amount) {
  Add(CellOf(point.x()), CellOf(point.y()), amount);
}

void OccupancyScores::AddToLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                std::int32_t amount) {
  std::int64_t x = CellOf(from.x()), y = CellOf(from.y());
  const std::int64_t last_x = CellOf(to.x()), last_y = CellOf(to.y());
  std::int64_t num_steps = std::abs(last_x - x) + std::abs(last_y - y);
  if (num_steps == 0) return;
  Crossings columns(from.x(), to.x() - from.x(), x), rows(from.y(), to.y() - from.y(), y);
  // Counted, so that rounding cannot lead past the end.
  for (; num_steps > 0; --num_steps) {
    const bool along_x = y == last_y || (x != last_x && columns.next < rows.next);
    Crossings& axis = along_x ? columns : rows;
    (along_x ? x : y) += axis.direction;
    axis.next += axis.step;
    Add(x, y, amount);
  }
}

void OccupancyScores::AddEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const bool up = from.y() < to.y();
  const Eigen::Vector2d& low = up ? from : to;
  const Eigen::Vector2d& high = up ? to : from;
  const int end = FirstCentre(high.y(), height_);
  int row = FirstCentre(low.y(), height_);
  if (row >= end) return;
  // What is to the right of an edge that leads up is inside a clockwise outline.
  const std::int32_t amount = up ? 1 : -1;
  const double slope = (high.x() - low.x()) / (high.y() - low.y());
  double x = low.x() + (row + 0.5 - low.y()) * slope;
  for (; row < end; ++row) {
    Difference(FirstCentre(x, width_), row) += amount;
    x += slope;
  }
}

std::vector<std::int32_t> OccupancyScores::Packed(std::size_t begin, std::size_t end) const {
  std::vector<std::int32_t> packed;
  for (std::size_t i = begin; i < end; ++i) {
    if (blocks_[i].empty()) continue;
    packed.push_back(static_cast<std::int32_t>(i));
    packed.insert(packed.end(), blocks_[i].begin(), blocks_[i].end());
  }
  return packed;
}

void OccupancyScores::AddPacked(const std::vector<std::int32_t>& packed) {
  for (auto from = packed.begin(); from != packed.end(); from += kCellsPerBlock) {
    Block& block = blocks_[*from++];
    block.resize(kCellsPerBlock);
    std::transform(block.begin(), block.end(), from, block.begin(), std::plus<>());
  }
}

bool OccupancyScores::AddThoseOf(const Peers* peers, int rank) {
  if (peers == nullptr) return true;
  const bool receives = rank == kEveryRank || rank == peers->rank();
  // In pieces of 4 MB: what is on its way takes memory once more.
  constexpr std::size_t kBlocksAtOnce = 256;
  for (std::size_t begin = 0; begin < blocks_.size(); begin += kBlocksAtOnce) {
    const std::size_t end = std::min(begin + kBlocksAtOnce, blocks_.size());
    const std::vector<std::int32_t> own = Packed(begin, end);
    std::vector<std::vector<std::int32_t>> to_rank(peers->size());
    for (int other = 0; other < peers->size(); ++other) {
      if (other != peers->rank() && (rank == kEveryRank || rank == other)) to_rank[other] = own;
    }
    if (!receives) std::fill(blocks_.begin() + begin, blocks_.begin() + end, Block());
    for (const std::vector<std::int32_t>& of_rank : ExchangeValues(*peers, to_rank)) {
      AddPacked(of_rank);
    }
  }
  return receives;
}

void OccupancyScores::Row(int y, std::vector<std::int32_t>* scores) const {
  scores->resize(width_);
  const Block* block = &blocks_[y / kBlockSide * blocks_per_row_];
  std::int32_t sum = 0;
  for (int first = 0; first < width_; first += kBlockSide, ++block) {
    const auto to = scores->begin() + first;
    const int count = std::min(kBlockSide, width_ - first);
    if (block->empty()) {
      std::fill_n(to, count, sum);
      continue;
    }
    const auto from = block->begin() + y % kBlockSide * kBlockSide;
    for (int x = 0; x < count; ++x) to[x] = sum += from[x];
  }
}

}  // namespace plumbline
