#include "plumbline/apps/evaluation/map_sharpness.h"

#include <algorithm>
#include <thread>

#include "plumbline/apps/evaluation/pose_timeline.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"

namespace plumbline {
namespace {

// Files keep six decimals of a second or fewer; no scanner is faster than a scan per millisecond.
constexpr double kSameTime_s = 1e-3;

}  // namespace

MapSharpness MeasureSharpness(const std::vector<double>& points) {
  ThreadPool pool(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  MapSharpness sharpness;
  sharpness.num_points = points.size() / 2;
  for (const double radius_m : {0.1, 0.15, 0.2}) {
    MapQualityOptions options;
    options.radius_m = radius_m;
    sharpness.radii.push_back({radius_m, MeasureMapQuality(points, options, &pool)});
  }
  return sharpness;
}

Status MeasureSharpnessOfLog(const std::string& log_path, const std::vector<TimedPose>& trajectory,
                             MapSharpness* sharpness) {
  CarmenLog log;
  PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(log_path, CarmenReadOptions(), &log));
  SlamGraph graph;
  PLUMBLINE_RETURN_IF_ERROR(BuildGraph(log, 0, &graph));
  const PoseTimeline timeline(trajectory);
  std::vector<double> points;
  std::size_t num_scans_without_pose = 0;
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& scan = graph.scan(s);
    const TimedPose* pose = timeline.Nearest(graph.timestamp_s(scan.pose), kSameTime_s);
    if (pose == nullptr) {
      ++num_scans_without_pose;
      continue;
    }
    for (std::size_t r = 0; r < scan.num_returns; ++r) {
      const Eigen::Vector2d point =
          pose->world_from_robot * graph.PointInRobot(scan.first_return + r);
      points.insert(points.end(), {point.x(), point.y()});
    }
  }
  if (points.empty()) {
    return Status::InvalidArgument(log_path + ": no scan with returns has a pose at its time");
  }
  *sharpness = MeasureSharpness(points);
  sharpness->num_scans_without_pose = num_scans_without_pose;
  return Status::Ok();
}

}  // namespace plumbline
