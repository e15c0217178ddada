#include "plumbline/solvers/full/held_out_ranges.h"

#include <Eigen/Core>
#include <cmath>

#include "plumbline/core/joined_returns.h"
#include "plumbline/solvers/association/held_out_returns.h"

namespace plumbline {
namespace {

// A step in range that noise may be, in standard deviations of a reading.
constexpr double kStepSigmas = 4.0;

}  // namespace

HeldOutRanges::HeldOutRanges(const SlamGraph& graph, double sigma_range_m, ThreadPool* pool)
    : graph_(graph), sigma_range_m_(sigma_range_m) {
  constexpr std::size_t kScansPerChunk = 64;
  const std::size_t num_scans = graph.num_scans();
  std::vector<std::vector<Range>> chunks(ThreadPool::NumChunks(num_scans, kScansPerChunk));
  const auto find = [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::vector<Eigen::Vector2d> measured;
    std::vector<bool> joined;
    for (std::size_t s = begin; s < end; ++s) {
      const int scan = static_cast<int>(s);
      MeasuredPoints(graph, scan, &measured);
      FindJoinedReturns(graph, scan, measured, kStepSigmas * sigma_range_m, &joined);
      const ScanReturns returns = graph.ReturnsOfScan(scan);
      const std::size_t first = graph.scan(scan).first_return;
      HeldOutReturns::ForEachOf(graph, scan, [&](std::size_t r) {
        const std::size_t k = r - first;
        if (k == 0 || k + 1 >= joined.size() || !joined[k] || !joined[k + 1]) return;
        const double before = returns.Bearing(r - 1), after = returns.Bearing(r + 1);
        const double share_after = (returns.Bearing(r) - before) / (after - before);
        chunks[chunk].push_back({scan, r - 1, r + 1, returns.Range(r), share_after});
      });
    }
  };
  pool->ForEachChunk(num_scans, kScansPerChunk, find);
  for (const std::vector<Range>& chunk : chunks) {
    ranges_.insert(ranges_.end(), chunk.begin(), chunk.end());
  }
}

double HeldOutRanges::MeanError(const MapState& state) const {
  double sum = 0.0;
  for (const Range& range : ranges_) {
    const Pose2 world_from_laser = state.WorldFromRobot(graph_.scan(range.scan).pose) *
                                   graph_.LaserOfScan(range.scan).robot_from_laser;
    const Eigen::Vector2d laser = world_from_laser.translation();
    const auto distance_m = [&](std::size_t r) {
      return (Eigen::Vector2d(state.points[2 * r], state.points[2 * r + 1]) - laser).norm();
    };
    // Along a line the inverse of the range is a sine of the bearing: straight over two beams.
    const double inverse = (1.0 - range.share_after) / distance_m(range.before) +
                           range.share_after / distance_m(range.after);
    sum += std::abs(range.range_m - 1.0 / inverse) / sigma_range_m_;
  }
  return ranges_.empty() ? 0.0 : sum / static_cast<double>(ranges_.size());
}

}  // namespace plumbline
