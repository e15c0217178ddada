#include "plumbline/apps/readers/pose_graph_log.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace plumbline {

Status LogOfPoseGraph(const SlamGraph& graph, int max_scans, SlamGraph* log) {
  if (graph.num_returns() == 0) {
    return Status::InvalidArgument("a pose graph without scans cannot be mapped with other logs");
  }
  std::vector<int> scans(graph.num_scans());
  std::iota(scans.begin(), scans.end(), 0);
  std::stable_sort(scans.begin(), scans.end(),
                   [&](int a, int b) { return graph.scan(a).pose < graph.scan(b).pose; });
  if (max_scans > 0 && max_scans < graph.num_scans()) scans.resize(max_scans);
  SlamGraph result;
  result.ReserveReturns(graph.num_returns());
  int last_pose = -1, pose = -1;
  for (const int scan : scans) {
    const int given_pose = graph.scan(scan).pose;
    if (given_pose != last_pose) {
      const Pose2 world_from_robot = graph.InitialPose(given_pose);
      pose = result.AddPose(world_from_robot, graph.timestamp_s(given_pose));
      if (pose > 0) {
        const Pose2 step = Between(result.InitialPose(pose - 1), world_from_robot);
        result.AddOdometry({pose - 1, pose, step});
      }
      last_pose = given_pose;
    }
    result.AddScanOf(graph, scan, pose);
  }
  PLUMBLINE_RETURN_IF_ERROR(result.status());
  *log = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
