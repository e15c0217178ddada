#include "plumbline/apps/evaluation/log_map.h"

#include <utility>

#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/core/sweep_motion.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/sweep_order.h"

namespace plumbline {

Status ReadLogMap(const std::string& log_path, const std::string& trajectory_path,
                  const std::vector<TimedPose>& trajectory, LogAtPoses* map) {
  SlamGraph log;
  LogNotes notes;
  PLUMBLINE_RETURN_IF_ERROR(ReadLogIntoGraph(log_path, 0, &notes, &log));
  std::vector<double> scan_times_s;
  scan_times_s.reserve(log.num_scans());
  for (int scan = 0; scan < log.num_scans(); ++scan) {
    scan_times_s.push_back(log.timestamp_s(log.scan(scan).pose));
  }
  Pairing pairing;
  PLUMBLINE_RETURN_IF_ERROR(ChoosePairing(
      {log_path, scan_times_s}, {trajectory_path, TimesOf(trajectory)}, kSameTime_s, &pairing));
  const PoseTimeline timeline(trajectory);
  LogAtPoses result;
  result.clock_is_useless = pairing.clock_is_useless;
  for (int scan = 0; scan < log.num_scans(); ++scan) {
    const double timestamp_s = scan_times_s[scan];
    const TimedPose* known =
        pairing.by_order ? &trajectory[scan] : timeline.Nearest(timestamp_s, kSameTime_s);
    if (known == nullptr) {
      ++result.num_scans_without_pose;
      continue;
    }
    const int pose = result.graph.AddPose(known->world_from_robot, timestamp_s);
    result.graph.AddScanOf(log, scan, pose);
  }
  PLUMBLINE_RETURN_IF_ERROR(result.graph.status());
  if (result.graph.num_returns() == 0) {
    return Status::InvalidArgument(log_path + ": no scan with returns has a pose at its time");
  }
  if (HasSweeps(result.graph)) {
    ThreadPool pool(1);
    const SweepOrder order = FindSweepOrder(SeedingOptions(), SolverOptions(), log, &pool);
    result.graph = result.graph.Corrected(
        TakeOutSweepMotion(result.graph, order, result.graph.initial_poses()));
  }
  *map = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
