#include "plumbline/core/joined_returns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace plumbline {
namespace {

// Two neighbouring returns belong to one surface if the surface meets the beam at no less than
// about 10 degrees: then they lie within (range x step) / sin(10 deg) of each other.
constexpr double kGrazingFactor = 5.8;

// Joined returns come from beams no further apart than this: one beam without return is bridged.
constexpr int kMaxBeamGap = 2;

}  // namespace

void MeasuredPoints(const SlamGraph& graph, int scan_id, std::vector<Eigen::Vector2d>* points) {
  const ScanEntry& scan = graph.scan(scan_id);
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  points->resize(scan.num_returns);
  for (std::size_t k = 0; k < scan.num_returns; ++k) {
    (*points)[k] = returns.PointInRobot(scan.first_return + k);
  }
}

void FindJoinedReturns(const SlamGraph& graph, int scan_id,
                       const std::vector<Eigen::Vector2d>& points, double reach_m,
                       std::vector<bool>* joined) {
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  const std::vector<float>& ranges_m = graph.returns().range_m;
  const double bearing_step_rad = std::abs(graph.LaserOfScan(scan_id).bearing_step_rad);
  joined->assign(points.size(), false);
  for (std::size_t k = 1; k < points.size(); ++k) {
    const std::size_t r = graph.scan(scan_id).first_return + k;
    // Points of one beam may be as far apart as neighbours.
    const int gap = std::max(returns.Beam(r) - returns.Beam(r - 1), 1);
    if (gap > kMaxBeamGap) continue;
    const double range_m = std::min(ranges_m[r], ranges_m[r - 1]);
    const double limit = std::max(reach_m, kGrazingFactor * gap * range_m * bearing_step_rad);
    (*joined)[k] = (points[k] - points[k - 1]).squaredNorm() <= limit * limit;
  }
}

}  // namespace plumbline
