#include "plumbline/apps/evaluation/log_map.h"

#include <algorithm>
#include <utility>

#include "plumbline/apps/evaluation/pose_timeline.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"

namespace plumbline {
Status ReadLogMap(const std::string& log_path, const std::vector<TimedPose>& trajectory,
                  LogMap* map) {
  CarmenLog log;
  PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(log_path, CarmenReadOptions(), &log));
  const PoseTimeline timeline(trajectory);
  const auto has_no_pose = [&timeline](const CarmenScan& scan) {
    return timeline.Nearest(scan.timestamp_s, kSameTime_s) == nullptr;
  };
  const auto first_without = std::remove_if(log.scans.begin(), log.scans.end(), has_no_pose);
  LogMap result;
  result.num_scans_without_pose = log.scans.end() - first_without;
  log.scans.erase(first_without, log.scans.end());
  if (!log.scans.empty()) PLUMBLINE_RETURN_IF_ERROR(BuildGraph(log, 0, &result.graph));
  if (result.graph.num_returns() == 0) {
    return Status::InvalidArgument(log_path + ": no scan with returns has a pose at its time");
  }
  for (int pose = 0; pose < result.graph.num_poses(); ++pose) {
    const double timestamp_s = result.graph.timestamp_s(pose);
    result.graph.SetPose(pose, timeline.Nearest(timestamp_s, kSameTime_s)->world_from_robot);
  }
  result.graph.ResetPointsFromPoses();
  *map = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
