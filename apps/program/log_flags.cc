#include "plumbline/apps/program/log_flags.h"

#include <gflags/gflags.h>

DEFINE_string(scan_topic, "",
              "ROS bag: topic of the laser (empty: the only sensor_msgs/LaserScan)");
DEFINE_string(
    odom_topic, "",
    "ROS bag: topic of the odometry (empty: the only nav_msgs/Odometry, or the transforms "
    "if there is none; /tf: the transforms)");
DEFINE_string(odom_frame, plumbline::BagReadOptions().odom_frame,
              "ROS bag: frame of the odometry in the transforms");

namespace plumbline {

BagReadOptions BagReadOptionsFromFlags() {
  BagReadOptions options;
  options.scan_topic = FLAGS_scan_topic;
  options.odom_topic = FLAGS_odom_topic;
  options.odom_frame = FLAGS_odom_frame;
  return options;
}

}  // namespace plumbline
