#include "plumbline/solvers/loop_closure/scans_along_path.h"

#include <cmath>

namespace plumbline {

std::vector<int> ScansAlongPath(const SlamGraph& graph, const std::vector<Pose2>& world_from_robot,
                                double spacing_m, double spacing_rad) {
  const std::vector<ScanEntry>& all = graph.all_scans();
  std::vector<int> scans;
  for (int scan = 0; scan < static_cast<int>(all.size()); ++scan) {
    if (all[scan].num_returns == 0) continue;
    if (!scans.empty()) {
      const Pose2 step =
          Between(world_from_robot[all[scans.back()].pose], world_from_robot[all[scan].pose]);
      if (step.translation().norm() < spacing_m && std::abs(step.yaw) < spacing_rad) continue;
    }
    scans.push_back(scan);
  }
  return scans;
}

}  // namespace plumbline
