#include "plumbline/apps/io/log_to_graph.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"

namespace plumbline {
namespace {

LaserModel ModelOf(const CarmenScan& scan, double sweep_time_s, const Pose2& robot_from_laser) {
  LaserModel laser;
  laser.num_beams = static_cast<int>(scan.ranges.size());
  laser.first_bearing_rad = scan.first_bearing_rad;
  laser.bearing_step_rad = scan.bearing_step_rad;
  laser.max_range_m = scan.max_range_m;
  laser.beam_period_s = sweep_time_s / laser.num_beams;
  laser.robot_from_laser = robot_from_laser;
  return laser;
}

bool HaveSamePose(const CarmenScan& a, const CarmenScan& b) {
  return a.odom_from_robot.x == b.odom_from_robot.x && a.odom_from_robot.y == b.odom_from_robot.y &&
         a.odom_from_robot.yaw == b.odom_from_robot.yaw;
}

bool HasOdometry(const CarmenLog& log) {
  return std::any_of(log.scans.begin(), log.scans.end(), [&](const CarmenScan& scan) {
    return !HaveSamePose(log.scans.front(), scan);
  });
}

// As the two poses of the scans say. Where all poses of a log are zero these say nothing, and the
// parameter of the robot does, if there is one.
Pose2 MountingOf(const CarmenLog& log, bool has_odometry) {
  const Pose2 mounting = EstimateLaserMounting(log).robot_from_laser;
  const auto offset = log.params.find("robot_frontlaser_offset");
  const bool is_unknown = mounting.x == 0.0 && mounting.y == 0.0 && mounting.yaw == 0.0;
  if (has_odometry || !is_unknown || offset == log.params.end()) return mounting;
  FieldReader reader(offset->second);
  const double offset_m = reader.Coordinate(offset->first.c_str());
  return reader.ok() ? Pose2(offset_m, 0.0, 0.0) : mounting;
}

// A pose for a scan, what was seen there, and how the robot came there.
void AppendScan(const CarmenLog& log, std::size_t index, const Pose2& robot_from_laser,
                bool has_odometry, SlamGraph* graph) {
  const CarmenScan& scan = log.scans[index];
  const int laser = graph->AddLaser(ModelOf(scan, log.sweep_time_s, robot_from_laser));
  const int pose =
      graph->AddPose(Between(log.scans[0].odom_from_robot, scan.odom_from_robot), scan.timestamp_s);
  graph->AddScan(pose, laser, scan.ranges);
  if (index == 0 || !has_odometry) return;
  graph->AddOdometry(
      {pose - 1, pose, Between(log.scans[index - 1].odom_from_robot, scan.odom_from_robot)});
}

// As many as there can be returns. What of their room is not used takes no memory.
std::size_t NumReadings(const CarmenLog& log, std::size_t num_scans) {
  std::size_t num_readings = 0;
  for (std::size_t i = 0; i < num_scans; ++i) num_readings += log.scans[i].ranges.size();
  return num_readings;
}

// done(scan): called once the graph has it.
template <typename Done>
Status Build(const CarmenLog& log, int max_scans, const Done& done, SlamGraph* graph) {
  if (log.scans.empty()) return Status::InvalidArgument("the log has no scans");
  if (max_scans < 0) {
    return Status::InvalidArgument("max_scans = " + std::to_string(max_scans) +
                                   ", but it must be >= 0");
  }
  std::size_t num_scans = log.scans.size();
  if (max_scans > 0) num_scans = std::min<std::size_t>(num_scans, max_scans);

  const bool has_odometry = HasOdometry(log);
  const Pose2 robot_from_laser = MountingOf(log, has_odometry);
  SlamGraph result;
  result.ReserveReturns(NumReadings(log, num_scans));
  for (std::size_t i = 0; i < num_scans; ++i) {
    AppendScan(log, i, robot_from_laser, has_odometry, &result);
    if (!result.status().ok()) {
      return Status::InvalidArgument("scan of line " + std::to_string(log.scans[i].line) + ": " +
                                     result.status().message());
    }
    done(i);
  }
  *graph = std::move(result);
  return Status::Ok();
}

}  // namespace

std::string LaserMounting::Disagreement() const {
  constexpr double kToleranceM = 0.05, kToleranceRad = 0.05;
  if (max_deviation_m <= kToleranceM && max_deviation_rad <= kToleranceRad) return "";
  std::ostringstream text;
  text << "the place of the laser on the robot differs by up to " << max_deviation_m << " m and "
       << RadToDeg(max_deviation_rad) << " deg between scans";
  return text.str();
}

LaserMounting EstimateLaserMounting(const CarmenLog& log) {
  // The yaw through sine and cosine: a laser that looks backwards has readings at both +-pi.
  std::vector<double> x, y, cosine, sine;
  for (const CarmenScan& scan : log.scans) {
    const Pose2 mounting = Between(scan.odom_from_robot, scan.odom_from_laser);
    x.push_back(mounting.x);
    y.push_back(mounting.y);
    cosine.push_back(std::cos(mounting.yaw));
    sine.push_back(std::sin(mounting.yaw));
  }
  LaserMounting result;
  result.robot_from_laser = {Median(x), Median(y), std::atan2(Median(sine), Median(cosine))};
  for (const CarmenScan& scan : log.scans) {
    const Pose2 deviation =
        Between(result.robot_from_laser, Between(scan.odom_from_robot, scan.odom_from_laser));
    result.max_deviation_m = std::max(result.max_deviation_m, std::hypot(deviation.x, deviation.y));
    result.max_deviation_rad = std::max(result.max_deviation_rad, std::abs(deviation.yaw));
  }
  return result;
}

Status BuildGraph(const CarmenLog& log, int max_scans, SlamGraph* graph) {
  return Build(
      log, max_scans, [](std::size_t) {}, graph);
}

Status BuildGraph(CarmenLog&& log, int max_scans, const std::function<void()>& freed,
                  SlamGraph* graph) {
  constexpr std::size_t kMany = std::size_t{1} << 25;  // bytes
  std::size_t num_bytes = 0;
  const auto free_scan = [&](std::size_t scan) {
    num_bytes += sizeof(double) * log.scans[scan].ranges.size();
    log.scans[scan].ranges = std::vector<double>();
    if (num_bytes < kMany) return;
    num_bytes = 0;
    freed();
  };
  return Build(log, max_scans, free_scan, graph);
}

}  // namespace plumbline
