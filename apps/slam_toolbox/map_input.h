#ifndef PLUMBLINE_APPS_SLAM_TOOLBOX_MAP_INPUT_H_
#define PLUMBLINE_APPS_SLAM_TOOLBOX_MAP_INPUT_H_

#include <plumbline/core/laser_scan.h>
#include <plumbline/core/pose2.h>
#include <plumbline/core/slam_graph.h>
#include <plumbline/core/status.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace plumbline {

// Whether a SlamGraph would take these, tried on a small one. Messages name them by the ids of the
// mapper.

inline Status NoSuchNode(int id) {
  return Status::NotFound("node " + std::to_string(id) + " is not in the map");
}

inline Status Named(const std::string& name, const Status& status) {
  return status.ok() ? status : Status::InvalidArgument(name + ": " + status.message());
}

inline Status CheckNode(int id, const Pose2& world_from_robot, double timestamp_s) {
  int pose = 0;
  SlamGraph trial;
  return Named("node " + std::to_string(id), trial.AddPose(world_from_robot, timestamp_s, &pose));
}

inline Status CheckScan(int id, const LaserModel& laser, const std::vector<double>& ranges_m) {
  const std::string name = "node " + std::to_string(id);
  int pose = 0, laser_id = 0;
  SlamGraph trial;
  PLUMBLINE_RETURN_IF_ERROR(trial.AddPose(Pose2(), 0.0, &pose));
  PLUMBLINE_RETURN_IF_ERROR(Named(name, trial.AddLaser(laser, &laser_id)));
  return Named(name, trial.AddScan(pose, laser_id, ranges_m));
}

inline Status CheckConstraint(int source, int target, const Pose2& source_from_target,
                              const Eigen::Matrix3d& covariance) {
  int from = 0, to = 0;
  SlamGraph trial;
  PLUMBLINE_RETURN_IF_ERROR(trial.AddPose(Pose2(), 0.0, &from));
  PLUMBLINE_RETURN_IF_ERROR(trial.AddPose(Pose2(), 0.0, &to));
  if (source == target) to = from;
  return Named("constraint " + std::to_string(source) + " -> " + std::to_string(target),
               trial.AddRelativePose({from, to, source_from_target, covariance}));
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SLAM_TOOLBOX_MAP_INPUT_H_
