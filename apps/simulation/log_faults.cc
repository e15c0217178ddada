#include "plumbline/apps/simulation/log_faults.h"

#include <algorithm>
#include <vector>

#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

// The first scan that is at this time or later.
std::size_t FirstScanFrom(double time_s, const SimulatedLog& log) {
  const auto first = std::partition_point(
      log.scans.begin(), log.scans.end(),
      [&](const SimulatedScan& scan) { return scan.scan.timestamp_s < time_s; });
  return first - log.scans.begin();
}

// The first scan that is after this time.
std::size_t FirstScanAfter(double time_s, const SimulatedLog& log) {
  const auto first = std::partition_point(
      log.scans.begin(), log.scans.end(),
      [&](const SimulatedScan& scan) { return scan.scan.timestamp_s <= time_s; });
  return first - log.scans.begin();
}

// From the second last scan of the log to its last [s]; 1 s if it has but one.
double LastStep(const SimulatedLog& log) {
  if (log.scans.size() < 2) return 1.0;
  return log.scans.back().scan.timestamp_s - log.scans[log.scans.size() - 2].scan.timestamp_s;
}

Pose2 Moved(const Pose2& motion, const Pose2& pose) {
  Pose2 moved = motion * pose;
  moved.yaw = NormalizeAngle(moved.yaw);
  return moved;
}

}  // namespace

std::size_t DropScans(double from_s, double duration_s, SimulatedLog* log) {
  const std::size_t first = std::max<std::size_t>(1, FirstScanFrom(from_s, *log));
  const std::size_t end = std::max(first, FirstScanFrom(from_s + duration_s, *log));
  log->scans.erase(log->scans.begin() + first, log->scans.begin() + end);
  return first;
}

std::size_t FreezeLaser(double from_s, double duration_s, SimulatedLog* log) {
  const std::size_t first = std::max<std::size_t>(1, FirstScanAfter(from_s, *log));
  const std::size_t end = FirstScanAfter(from_s + duration_s, *log);
  for (std::size_t i = first; i < end; ++i) {
    log->scans[i].scan.ranges = log->scans[first - 1].scan.ranges;
    log->scans[i].hits = log->scans[first - 1].hits;
  }
  return first;
}

std::size_t RepeatStretch(double from_s, double duration_s, SimulatedLog* log) {
  std::vector<SimulatedScan>& scans = log->scans;
  const std::size_t first = FirstScanFrom(from_s, *log);
  const std::size_t end = FirstScanFrom(from_s + duration_s, *log);
  if (first >= end) return scans.size();
  const double end_s = end < scans.size() ? scans[end].scan.timestamp_s
                                          : scans.back().scan.timestamp_s + LastStep(*log);
  const std::vector<SimulatedScan> copies(scans.begin() + first, scans.begin() + end);
  const double shift_s = end_s - copies.front().scan.timestamp_s;
  scans.insert(scans.begin() + end, copies.begin(), copies.end());
  for (std::size_t i = end; i < scans.size(); ++i) scans[i].scan.timestamp_s += shift_s;
  return end;
}

Status AppendLog(const SimulatedLog& next, SimulatedLog* log, std::size_t* first_scan) {
  if (log->scans.empty() || next.scans.empty()) {
    return Status::InvalidArgument("appending a log: one of the two has no scan");
  }
  if (!(log->laser == next.laser)) {
    return Status::InvalidArgument("appending a log: it has another laser");
  }
  const SimulatedScan last = log->scans.back(), start = next.scans.front();
  const double step_s = next.scans.size() > 1
                            ? next.scans[1].scan.timestamp_s - start.scan.timestamp_s
                            : LastStep(*log);
  const double shift_s = last.scan.timestamp_s + step_s - start.scan.timestamp_s;
  const Pose2 odom_from_next = last.odom_from_robot * start.odom_from_robot.Inverse();
  const Pose2 world_from_next = last.world_from_robot * start.world_from_robot.Inverse();
  *first_scan = log->scans.size();
  for (SimulatedScan scan : next.scans) {
    scan.scan.timestamp_s += shift_s;
    scan.odom_from_robot = Moved(odom_from_next, scan.odom_from_robot);
    scan.world_from_robot = Moved(world_from_next, scan.world_from_robot);
    for (Eigen::Vector2d& hit : scan.hits) hit = world_from_next * hit;
    log->scans.push_back(std::move(scan));
  }
  log->path_length_m += next.path_length_m;
  return Status::Ok();
}

}  // namespace plumbline
