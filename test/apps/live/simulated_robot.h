#ifndef PLUMBLINE_TEST_APPS_LIVE_SIMULATED_ROBOT_H_
#define PLUMBLINE_TEST_APPS_LIVE_SIMULATED_ROBOT_H_

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/pose2.h"

namespace plumbline {

/// The time of the first scan of a SimulatedRobot [s].
constexpr double kRobotStartS = 100.0;

inline RosPose PlanarPose(const Pose2& pose, double z = 0.0) {
  RosPose result;
  result.position = {pose.x, pose.y, z};
  result.rotation =
      Eigen::Quaterniond(std::cos(0.5 * pose.yaw), 0.0, 0.0, std::sin(0.5 * pose.yaw));
  return result;
}

/// A drive through an office that comes back to where it was, as the messages of a robot: odom ->
/// base_link at the time of each scan, and base_link -> laser, which sits 0.2 m ahead.
class SimulatedRobot {
 public:
  SimulatedRobot() {
    SimulationOptions options;
    options.scan_period_s = 1.0;
    options.laser.num_beams = 180;
    options.laser.bearing_step_rad = DegToRad(1.0);
    options.laser.robot_from_laser = {0.2, 0.0, 0.0};
    options.odometry_noise.scale_error = 0.03;
    is_good_ = Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log_).ok();
  }

  bool is_good() const { return is_good_; }
  int num_scans() const { return static_cast<int>(log_.scans.size()); }
  const SimulatedLog& log() const { return log_; }
  double StampS(int i) const { return kRobotStartS + log_.scans[i].scan.timestamp_s; }

  /// A message of a scan, in which numbers have the precision of a float.
  RosScan Scan(int i) const {
    RosScan scan;
    scan.stamp_s = StampS(i);
    scan.frame = "laser";
    scan.angle_min_rad = static_cast<float>(log_.laser.first_bearing_rad);
    scan.angle_max_rad = static_cast<float>(log_.laser.Bearing(log_.laser.num_beams - 1));
    scan.angle_increment_rad = static_cast<float>(log_.laser.bearing_step_rad);
    scan.range_min_m = static_cast<float>(log_.laser.min_range_m);
    scan.range_max_m = static_cast<float>(log_.laser.max_range_m);
    for (const double range_m : log_.scans[i].scan.ranges) {
      scan.ranges.push_back(static_cast<float>(range_m));
    }
    return scan;
  }
  std::vector<RosTransform> OdometryTransform(int i) const {
    return {{StampS(i), "odom", "base_link", PlanarPose(log_.scans[i].odom_from_robot)}};
  }
  RosOdometry Odometry(int i) const {
    return {StampS(i), "odom", "base_link", PlanarPose(log_.scans[i].odom_from_robot)};
  }
  std::vector<RosTransform> StaticTransforms() const {
    return {{0.0, "base_link", "laser", PlanarPose(log_.laser.robot_from_laser, 0.3)}};
  }

 private:
  SimulatedLog log_;
  bool is_good_ = false;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_LIVE_SIMULATED_ROBOT_H_
