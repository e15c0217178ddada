#include "plumbline/core/joined_returns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace plumbline {
namespace {

// Two neighbouring returns belong to one surface if the surface meets the beam at no less than
// about 10 degrees: then they lie within (range x step) / sin(10 deg) of each other.
constexpr double kGrazingFactor = 5.8;

// One missing return is bridged: joined returns come from beams no further apart than this many
// times the spacing of the beams that return.
constexpr int kMaxSpacings = 2;
// Neighbouring beams further apart than this [rad] mostly hit different walls. On simulated floors
// 24 beams over 360 degrees give good maps, and 16 beams mislead the scan matching.
constexpr double kMaxGapRad = 0.3;

// From the beam of a return to that of the return before it, which may be the same beam.
int BeamGap(const ScanReturns& returns, std::size_t r) {
  return std::max(returns.Beam(r) - returns.Beam(r - 1), 1);
}

// Beams from one return to the next, at least. More than 1 if a driver drops every other beam.
int BeamSpacing(const SlamGraph& graph, int scan_id) {
  const ScanEntry& scan = graph.scan(scan_id);
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  int spacing = std::numeric_limits<int>::max();
  for (std::size_t k = 1; k < scan.num_returns && spacing > 1; ++k) {
    spacing = std::min(spacing, BeamGap(returns, scan.first_return + k));
  }
  return spacing;
}

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
  if (points.size() < 2) return;
  const int max_gap = kMaxSpacings * BeamSpacing(graph, scan_id);
  for (std::size_t k = 1; k < points.size(); ++k) {
    const std::size_t r = graph.scan(scan_id).first_return + k;
    const int gap = BeamGap(returns, r);
    if (gap > max_gap || gap * bearing_step_rad > kMaxGapRad) continue;
    const double range_m = std::min(ranges_m[r], ranges_m[r - 1]);
    const double limit = std::max(reach_m, kGrazingFactor * gap * range_m * bearing_step_rad);
    (*joined)[k] = (points[k] - points[k - 1]).squaredNorm() <= limit * limit;
  }
}

}  // namespace plumbline
