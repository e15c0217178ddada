#include "plumbline/apps/live/live_map.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace plumbline {
namespace {

// A scan is taken into the grids if the robot has moved by as much as this since the last one.
constexpr double kKeyMoveM = 0.1, kKeyTurnRad = 0.1;

// Most cells of a grid that goes over a network: 1 km by 400 m of 5 cm.
constexpr double kMaxLiveCells = 1.6e8;

}  // namespace

LiveMapBuilder::LiveMapBuilder(const LaserModel& laser) : laser_(laser) {}

void LiveMapBuilder::Add(int index, double stamp_s, const LaserScan& scan,
                         const Pose2& map_from_robot) {
  const Pose2 motion = Between(last_, map_from_robot);
  if (has_last_ && motion.translation().norm() < kKeyMoveM && std::abs(motion.yaw) < kKeyTurnRad) {
    return;
  }
  has_last_ = true;
  last_ = map_from_robot;
  const std::lock_guard<std::mutex> lock(mutex_);
  new_.push_back({index, stamp_s, scan});
}

Status LiveMapBuilder::TakeNewScans() {
  std::vector<KeyScan> scans;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    scans.swap(new_);
  }
  const int laser = graph_.AddLaser(laser_);
  for (const KeyScan& key : scans) {
    const int pose = graph_.AddPose(Pose2(), key.scan.timestamp_s);
    graph_.AddScan(pose, laser, key.scan.ranges);
    PLUMBLINE_RETURN_IF_ERROR(graph_.TakeStatus());
    indices_.push_back(key.index);
    stamps_s_.push_back(key.stamp_s);
  }
  return Status::Ok();
}

Status LiveMapBuilder::Build(const OnlineMapper& mapper, double resolution_m, LiveMap* live_map) {
  const std::lock_guard<std::mutex> lock(building_);
  PLUMBLINE_RETURN_IF_ERROR(TakeNewScans());
  OnlineMap map;  // after that, so that it has all of these scans
  PLUMBLINE_RETURN_IF_ERROR(mapper.GetMap(&map));
  LiveMap result;
  MapState state;
  for (std::size_t i = 0; i < indices_.size(); ++i) {
    const Pose2& pose = map.map_from_robot[indices_[i]];
    state.poses.insert(state.poses.end(), {pose.x, pose.y, pose.yaw});
    result.path.push_back({stamps_s_[i], pose});
  }
  if (result.path.empty()) return Status::InvalidArgument("there are no scans yet");
  state.points = graph_.MeasuredMap(state.poses);
  OccupancyGridOptions options;
  options.resolution_m = resolution_m;
  options.max_cells = kMaxLiveCells;
  options.coarsen_to_fit = true;
  PLUMBLINE_RETURN_IF_ERROR(BuildOccupancyGrid(graph_, state, options, &result.grid));
  result.stamp_s = stamps_s_.back();
  result.num_scans = static_cast<int>(map.map_from_robot.size());
  result.num_closures = map.num_closures;
  result.alarms = map.alarms;
  *live_map = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
