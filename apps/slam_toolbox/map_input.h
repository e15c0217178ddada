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
  SlamGraph trial;
  trial.AddPose(world_from_robot, timestamp_s);
  return Named("node " + std::to_string(id), trial.status());
}

inline Status CheckScan(int id, const LaserModel& laser, const std::vector<double>& ranges_m) {
  SlamGraph trial;
  trial.AddScan(trial.AddPose(Pose2(), 0.0), trial.AddLaser(laser), ranges_m);
  return Named("node " + std::to_string(id), trial.status());
}

inline Status CheckConstraint(int source, int target, const Pose2& source_from_target,
                              const Eigen::Matrix3d& covariance) {
  SlamGraph trial;
  const int from = trial.AddPose(Pose2(), 0.0), other = trial.AddPose(Pose2(), 0.0);
  trial.AddRelativePose({from, source == target ? from : other, source_from_target, covariance});
  return Named("constraint " + std::to_string(source) + " -> " + std::to_string(target),
               trial.status());
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SLAM_TOOLBOX_MAP_INPUT_H_
