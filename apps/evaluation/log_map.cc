#include "plumbline/apps/evaluation/log_map.h"

#include <utility>

#include "plumbline/apps/evaluation/pose_timeline.h"
#include "plumbline/apps/read_log.h"

namespace plumbline {
Status ReadLogMap(const std::string& log_path, const std::vector<TimedPose>& trajectory,
                  LogMap* map) {
  SlamGraph log;
  LogCounts counts;
  PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(log_path, 0, &counts, &log));
  const PoseTimeline timeline(trajectory);
  LogMap result;
  for (int scan = 0; scan < log.num_scans(); ++scan) {
    const double timestamp_s = log.timestamp_s(log.scan(scan).pose);
    const TimedPose* known = timeline.Nearest(timestamp_s, kSameTime_s);
    if (known == nullptr) {
      ++result.num_scans_without_pose;
      continue;
    }
    int pose = 0;
    PLUMBLINE_RETURN_IF_ERROR(result.graph.AddPose(known->world_from_robot, timestamp_s, &pose));
    PLUMBLINE_RETURN_IF_ERROR(result.graph.AddScanOf(log, scan, pose));
  }
  if (result.graph.num_returns() == 0) {
    return Status::InvalidArgument(log_path + ": no scan with returns has a pose at its time");
  }
  *map = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
