#include "plumbline/apps/simulation/log_graph.h"

#include <utility>

namespace plumbline {

Status MakeGraph(const SimulatedLog& log, SlamGraph* graph) {
  SlamGraph result;
  const int laser = result.AddLaser(log.laser);
  result.ReserveReturns(log.scans.size() * log.laser.num_beams);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const SimulatedScan& scan = log.scans[i];
    const int pose = result.AddPose(Between(log.scans[0].odom_from_robot, scan.odom_from_robot),
                                    scan.scan.timestamp_s);
    result.AddScan(pose, laser, scan.scan.ranges);
    if (i == 0) continue;
    result.AddOdometry(
        {pose - 1, pose, Between(log.scans[i - 1].odom_from_robot, scan.odom_from_robot)});
  }
  PLUMBLINE_RETURN_IF_ERROR(result.status());
  *graph = std::move(result);
  return Status::Ok();
}

MapEstimate TruthOf(const SimulatedLog& log, const SlamGraph& graph) {
  MapEstimate truth;
  const Pose2 map_from_world = log.scans.front().world_from_robot.Inverse();
  for (const SimulatedScan& scan : log.scans) {
    truth.poses.push_back(Between(log.scans.front().world_from_robot, scan.world_from_robot));
  }
  for (std::size_t r = 0; r < graph.num_returns(); ++r) {
    const SimulatedScan& scan = log.scans[graph.ScanOfReturn(r)];
    const Eigen::Vector2d point = map_from_world * scan.hits[graph.Beam(r)];
    truth.points.insert(truth.points.end(), {point.x(), point.y()});
  }
  return truth;
}

}  // namespace plumbline
