#include "plumbline/solvers/front_end/scan_surfaces.h"

#include <algorithm>
#include <cstddef>

namespace plumbline {

SurfacePoints ScanSurfaces::Of(int scan) const {
  if (measured_ == nullptr || !kept_[scan].empty()) return kept_[scan];
  return ThinnedSurfaceOf(*graph_, scan, *measured_, kPointSpacingM);
}

bool ScanSurfaces::IsEmpty(int scan) const {
  if (measured_ == nullptr) return kept_[scan].empty();
  const ScanEntry& entry = graph_->scan(scan);
  const auto first = measured_->normals.begin() + static_cast<std::ptrdiff_t>(entry.first_return);
  return std::all_of(first, first + static_cast<std::ptrdiff_t>(entry.num_returns),
                     [](const ReturnNormal& normal) { return normal.IsNone(); });
}

std::vector<int> MatchedScanOfPoses(const SlamGraph& graph, const ScanSurfaces& surfaces) {
  std::vector<int> scan_of_pose(graph.num_poses(), -1);
  for (int s = graph.num_scans() - 1; s >= 0; --s) {
    if (!surfaces.IsEmpty(s)) scan_of_pose[graph.scan(s).pose] = s;
  }
  return scan_of_pose;
}

}  // namespace plumbline
