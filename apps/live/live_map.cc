#include "plumbline/apps/live/live_map.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace plumbline {
namespace {

// Motion of the robot after which the next scan is taken into the grids.
constexpr double kKeyMoveM = 0.1, kKeyTurnRad = 0.1;

// Most cells of a grid that goes over a network: 1 km by 400 m of 5 cm.
constexpr double kMaxLiveCells = 1.6e8;

}  // namespace

LiveMapBuilder::LiveMapBuilder(const LaserModel& laser, const SlamGraph* saved_map)
    : laser_(laser) {
  if (saved_map == nullptr) return;
  graph_ = *saved_map;
  is_fixed_ = saved_map->has_named_fixed_poses();
}

void LiveMapBuilder::Add(int index, double stamp_s, const LaserScan& scan,
                         const Pose2& map_from_robot) {
  const Pose2 motion = Between(last_, map_from_robot);
  if (has_last_ && motion.translation().norm() < kKeyMoveM && std::abs(motion.yaw) < kKeyTurnRad) {
    return;
  }
  has_last_ = true;
  last_ = map_from_robot;
  const std::lock_guard<std::mutex> lock(mutex_);
  new_.push_back({index, stamp_s, is_fixed_ ? LaserScan() : scan});
}

Status LiveMapBuilder::TakeNewScans() {
  std::vector<KeyScan> scans;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    scans.swap(new_);
  }
  for (const KeyScan& key : scans) {
    if (!is_fixed_) {
      const int pose = graph_.AddPose(Pose2(), key.scan.timestamp_s);
      graph_.AddScan(pose, graph_.AddLaser(laser_), key.scan.ranges);
      PLUMBLINE_RETURN_IF_ERROR(graph_.TakeStatus());
    }
    indices_.push_back(key.index);
    stamps_s_.push_back(key.stamp_s);
  }
  return Status::Ok();
}

Status LiveMapBuilder::BuildGrid(const LiveMap& map, double resolution_m, OccupancyGrid* grid) {
  MapState state;
  const std::vector<double>& initial = graph_.initial_poses();
  const std::size_t num_drive_poses = is_fixed_ ? 0 : map.path.size();
  state.poses.assign(initial.begin(),
                     initial.end() - static_cast<std::ptrdiff_t>(3 * num_drive_poses));
  for (std::size_t i = 0; i < num_drive_poses; ++i) {
    const Pose2& pose = map.path[i].world_from_robot;
    state.poses.insert(state.poses.end(), {pose.x, pose.y, pose.yaw});
  }
  state.points = graph_.MeasuredMap(state.poses);
  OccupancyGridOptions options;
  options.resolution_m = resolution_m;
  options.max_cells = kMaxLiveCells;
  options.coarsen_to_fit = true;
  return BuildOccupancyGrid(graph_, state, options, grid);
}

Status LiveMapBuilder::Build(const OnlineMapper& mapper, double resolution_m, LiveMap* live_map) {
  const std::lock_guard<std::mutex> lock(building_);
  // Where the drive lies in a saved map may not be known yet.
  OnlineMap map;
  PLUMBLINE_RETURN_IF_ERROR(mapper.GetMap(&map));
  if (map.is_in_map) {
    PLUMBLINE_RETURN_IF_ERROR(TakeNewScans());
    PLUMBLINE_RETURN_IF_ERROR(mapper.GetMap(&map));  // again: it then has all of these scans
  }
  if (graph_.num_scans() == 0) return Status::InvalidArgument("there are no scans yet");
  LiveMap result;
  for (std::size_t i = 0; i < indices_.size(); ++i) {
    result.path.push_back({stamps_s_[i], map.map_from_robot[indices_[i]]});
  }
  if (!is_fixed_ || fixed_grid_.cells.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(BuildGrid(result, resolution_m, &result.grid));
    if (is_fixed_) fixed_grid_ = result.grid;
  } else {
    result.grid = fixed_grid_;
  }
  if (!stamps_s_.empty()) result.stamp_s = stamps_s_.back();
  result.num_scans = static_cast<int>(map.map_from_robot.size());
  result.num_closures = map.num_closures;
  result.alarms = map.alarms;
  *live_map = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
