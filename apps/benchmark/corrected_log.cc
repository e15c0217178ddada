#include "plumbline/apps/benchmark/corrected_log.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/core/pose2.h"

namespace plumbline {

Status PairCorrectedLog(const CarmenLog& raw, const CarmenLog& corrected, CorrectedLog* pair) {
  const Pose2 laser_from_robot = EstimateLaserMounting(raw).robot_from_laser.Inverse();
  CorrectedLog result;
  auto next = raw.scans.begin();
  for (const CarmenScan& scan : corrected.scans) {
    const auto same = std::find_if(next, raw.scans.end(), [&scan](const CarmenScan& other) {
      return other.ranges == scan.ranges;
    });
    if (same == raw.scans.end()) continue;
    next = same + 1;
    result.raw.scans.push_back(*same);
    result.corrected.scans.push_back(*same);
    result.corrected.scans.back().odom_from_laser = scan.odom_from_laser;
    result.corrected.scans.back().odom_from_robot = scan.odom_from_laser * laser_from_robot;
  }
  if (2 * result.raw.scans.size() < corrected.scans.size() || result.raw.scans.empty()) {
    return Status::InvalidArgument("only " + std::to_string(result.raw.scans.size()) + " of " +
                                   std::to_string(corrected.scans.size()) +
                                   " corrected scans are in the raw log");
  }
  *pair = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
