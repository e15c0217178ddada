#include "plumbline/apps/simulation/carmen_writer.h"

#include <cmath>
#include <ios>
#include <ostream>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/robot_laser_record.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

constexpr double kAngleTolerance = 1e-9;

struct Velocity {
  double translation_m_s = 0.0;
  double rotation_rad_s = 0.0;
};

// What FLASER leaves unsaid: 180 deg from -90 deg on, both ends included if n is odd.
bool FitsFlaser(const LaserModel& laser) {
  const int num_steps = laser.num_beams % 2 == 1 ? laser.num_beams - 1 : laser.num_beams;
  return std::abs(laser.first_bearing_rad + 0.5 * kPi) < kAngleTolerance && num_steps > 0 &&
         std::abs(laser.bearing_step_rad * num_steps - kPi) < kAngleTolerance;
}

// As the wheels see it, from the scan before to this one.
Velocity OdometryVelocity(const SimulatedLog& log, std::size_t scan) {
  if (scan == 0) return {};
  const SimulatedScan &last = log.scans[scan - 1], &current = log.scans[scan];
  const Pose2 step = Between(last.odom_from_robot, current.odom_from_robot);
  const double period_s = current.scan.timestamp_s - last.scan.timestamp_s;
  return {step.x / period_s, step.yaw / period_s};
}

// Ranges and the limit that they are compared with on reading are rounded alike.
void WriteRange(double range_m, std::ostream* out) {
  const std::streamsize precision = out->precision(3);
  *out << ' ' << range_m;
  out->precision(precision);
}

void WritePose(const Pose2& pose, std::ostream* out) {
  *out << ' ' << pose.x << ' ' << pose.y << ' ' << NormalizeAngle(pose.yaw);
}

void WriteStamp(double time_s, std::ostream* out) {
  *out << ' ' << time_s << " simulator " << time_s << '\n';
}

double Rounded(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit;
}

Pose2 Rounded(const Pose2& pose) {
  return {Rounded(pose.x, 1e6), Rounded(pose.y, 1e6), Rounded(NormalizeAngle(pose.yaw), 1e6)};
}

// With the decimals that FLASER would have; but the bearings exactly, since an error of the step
// adds up along the beams.
CarmenScan RobotLaserOf(const LaserModel& laser, const SimulatedScan& scan) {
  CarmenScan record;
  record.timestamp_s = Rounded(scan.scan.timestamp_s, 1e6);
  record.odom_from_laser = Rounded(scan.odom_from_robot * laser.robot_from_laser);
  record.odom_from_robot = Rounded(scan.odom_from_robot);
  for (const double range_m : scan.scan.ranges) record.ranges.push_back(Rounded(range_m, 1e3));
  record.first_bearing_rad = laser.first_bearing_rad;
  record.bearing_step_rad = laser.bearing_step_rad;
  record.max_range_m = Rounded(laser.max_range_m, 1e3);
  return record;
}

void WriteFlaser(const LaserModel& laser, const SimulatedScan& scan, std::ostream* out) {
  *out << "FLASER " << scan.scan.ranges.size();
  for (const double range : scan.scan.ranges) WriteRange(range, out);
  WritePose(scan.odom_from_robot * laser.robot_from_laser, out);
  WritePose(scan.odom_from_robot, out);
  WriteStamp(scan.scan.timestamp_s, out);
}

void WriteScan(const LaserModel& laser, const SimulatedScan& scan, const Velocity& velocity,
               std::ostream* out) {
  *out << "ODOM";
  WritePose(scan.odom_from_robot, out);
  *out << ' ' << velocity.translation_m_s << ' ' << velocity.rotation_rad_s << " 0";
  WriteStamp(scan.scan.timestamp_s, out);
  if (FitsFlaser(laser)) {
    WriteFlaser(laser, scan, out);
  } else {
    *out << RobotLaserRecord(RobotLaserOf(laser, scan)) << '\n';
  }
}

}  // namespace

Status WriteCarmenLog(const std::string& path, const SimulatedLog& log) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << std::fixed;
  out.precision(6);
  out << "PARAM robot_frontlaser_offset " << log.laser.robot_from_laser.x;
  WriteStamp(0.0, &out);
  out << "PARAM robot_front_laser_max";
  WriteRange(log.laser.max_range_m, &out);
  WriteStamp(0.0, &out);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    WriteScan(log.laser, log.scans[i], OdometryVelocity(log, i), &out);
  }
  return file.Commit();
}

}  // namespace plumbline
