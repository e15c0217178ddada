#include "plumbline/core/joined_returns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/pose_frame.h"

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
  const PoseFrame laser(graph.laser(scan.laser).robot_from_laser);
  points->resize(scan.num_returns);
  for (std::size_t k = 0; k < scan.num_returns; ++k) {
    (*points)[k] = laser.Rotate(graph.PointInLaser(scan.first_return + k)) + laser.translation();
  }
}

void FindJoinedReturns(const SlamGraph& graph, int scan_id,
                       const std::vector<Eigen::Vector2d>& points, double reach_m,
                       std::vector<bool>* joined) {
  const LaserReturns& returns = graph.returns();
  const double bearing_step_rad = std::abs(graph.LaserOfScan(scan_id).bearing_step_rad);
  joined->assign(points.size(), false);
  for (std::size_t k = 1; k < points.size(); ++k) {
    const std::size_t r = graph.scan(scan_id).first_return + k;
    // Points of one beam may be as far apart as neighbours.
    const int gap = std::max(returns.beam[r] - returns.beam[r - 1], 1);
    if (gap > kMaxBeamGap) continue;
    const double range_m = std::min(returns.range_m[r], returns.range_m[r - 1]);
    const double limit = std::max(reach_m, kGrazingFactor * gap * range_m * bearing_step_rad);
    (*joined)[k] = (points[k] - points[k - 1]).squaredNorm() <= limit * limit;
  }
}

}  // namespace plumbline
