#include "plumbline/apps/io/robot_laser_record.h"

#include "plumbline/apps/io/number_text.h"

namespace plumbline {

std::string RobotLaserRecord(const CarmenScan& scan) {
  std::string text = "ROBOTLASER1 0";
  const auto add = [&text](double value) { text += ' ' + ExactText(value); };
  add(scan.first_bearing_rad);
  add(scan.bearing_step_rad * (static_cast<double>(scan.ranges.size()) - 1.0));
  add(scan.bearing_step_rad);
  add(scan.max_range_m);
  text += " 0 0 " + std::to_string(scan.ranges.size());
  for (const double range_m : scan.ranges) add(range_m);
  text += " 0";
  for (const Pose2& pose : {scan.odom_from_laser, scan.odom_from_robot}) {
    add(pose.x);
    add(pose.y);
    add(pose.yaw);
  }
  text += " 0 0 0 0 0";
  add(scan.timestamp_s);
  text += " plumbline";
  add(scan.timestamp_s);
  return text;
}

}  // namespace plumbline
