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

// Spacing of the beams in use: more than 1 if a driver drops every other beam. At least half of the
// returns are that far from the one before then, and none is nearer. Few returns far apart are none
// of that.
int BeamSpacing(const SlamGraph& graph, int scan_id) {
  const ScanEntry& scan = graph.scan(scan_id);
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  int least = std::numeric_limits<int>::max();
  std::size_t num_least = 0;
  for (std::size_t k = 1; k < scan.num_returns && least > 1; ++k) {
    const int gap = BeamGap(returns, scan.first_return + k);
    if (gap < least) num_least = 0;
    least = std::min(least, gap);
    if (gap == least) ++num_least;
  }
  return 2 * num_least >= scan.num_returns - 1 ? least : 1;
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
