#include "plumbline/core/copy_factor.h"

#include <cstddef>
#include <utility>

namespace plumbline {

void CopyFactor(const SlamGraph& from, const CustomFactor& factor, const IdThere& pose_there,
                const IdThere& scan_there, SlamGraph* to) {
  CustomFactor copy = factor;
  for (int& pose : copy.poses) {
    pose = pose_there(pose);
    if (pose < 0) return;
  }
  for (std::size_t& point : copy.points) {
    const int scan = from.ScanOfReturn(point);
    const int there = scan_there(scan);
    if (there < 0) return;
    point = to->scan(there).first_return + (point - from.scan(scan).first_return);
  }
  to->AddFactor(copy.name, std::move(copy.cost), std::move(copy.poses), std::move(copy.points),
                std::move(copy.loss));
}

}  // namespace plumbline
