#include "plumbline/apps/program/log_flags.h"

#include <gflags/gflags.h>

DEFINE_string(scan_topic, "",
              "ROS bag: topic of the laser (empty: the only sensor_msgs/LaserScan)");
DEFINE_string(
    odom_topic, "",
    "ROS bag: topic of the odometry (empty: the only nav_msgs/Odometry, or the transforms "
    "if there is none, or the scans alone; /tf: the transforms)");
DEFINE_string(odom_frame, plumbline::BagReadOptions().odom_frame,
              "ROS bag: frame of the odometry in the transforms");

DEFINE_double(sweep_time_s, -1.0,
              "Time that the laser takes from the first beam of a sweep to the last [s]; 0: all "
              "beams at once; negative: what the scans of a bag say, 0 for other logs");

namespace {

// A laser that takes longer is none that sweeps.
bool IsSweepTime(const char* /*flag*/, double sweep_time_s) { return sweep_time_s <= 60.0; }

}  // namespace

DEFINE_validator(sweep_time_s, &IsSweepTime);

namespace plumbline {

BagReadOptions BagReadOptionsFromFlags() {
  BagReadOptions options;
  options.scan_topic = FLAGS_scan_topic;
  options.odom_topic = FLAGS_odom_topic;
  options.odom_frame = FLAGS_odom_frame;
  options.needs_odometry = !gflags::GetCommandLineFlagInfoOrDie("odom_frame").is_default;
  return options;
}

std::optional<double> SweepTimeFromFlags() {
  return FLAGS_sweep_time_s < 0.0 ? std::nullopt : std::optional<double>(FLAGS_sweep_time_s);
}

}  // namespace plumbline
