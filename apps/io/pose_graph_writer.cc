#include "plumbline/apps/io/pose_graph_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/io/pose_graph_records.h"
#include "plumbline/apps/io/robot_laser_record.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/factors/sqrt_information.h"

namespace plumbline {
namespace {

constexpr PoseGraphFormat kWritten = PoseGraphFormat::kG2o;

// x y yaw, each after a blank.
std::string PoseText(const Pose2& pose) {
  return ' ' + ExactText(pose.x) + ' ' + ExactText(pose.y) + ' ' + ExactText(pose.yaw);
}

std::string EdgeText(int from, int to, const Pose2& motion, const Eigen::Matrix3d& covariance) {
  const PoseGraphDialect& dialect = DialectOf(kWritten);
  Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
  // In the axes of `to`, as the formats have it. The graph takes no covariance that this could fail
  // on.
  SqrtInformation(RotateAxes(covariance, -motion.yaw), &root);
  const Eigen::Matrix3d information = root.transpose() * root;
  std::string text = dialect.edge + (' ' + std::to_string(from)) + ' ' + std::to_string(to);
  text += PoseText(motion);
  for (const char* field : dialect.information) {
    const int row = field[1] - '1', column = field[2] - '1';
    text += ' ' + ExactText(information(row, column));
  }
  return text;
}

// One reading per beam, counter-clockwise.
Status ReadingsOf(const SlamGraph& graph, int scan, std::vector<double>* readings) {
  constexpr double kToleranceRad = 1e-9;
  const LaserModel& laser = graph.LaserOfScan(scan);
  // ReadCarmenLog looks for a level that stands for "no echo" within 1 % below the largest reading.
  const double no_return = std::ceil(1.02 * laser.max_range_m);
  readings->assign(laser.num_beams, no_return);
  const ScanEntry& entry = graph.scan(scan);
  const ScanReturns returns = graph.ReturnsOfScan(scan);
  for (std::size_t r = entry.first_return; r < entry.first_return + entry.num_returns; ++r) {
    const int beam = returns.Beam(r);
    const double off_rad = returns.Bearing(r) - laser.Bearing(beam);
    if (std::abs(off_rad) > kToleranceRad || (*readings)[beam] != no_return) {
      return Status::InvalidArgument("scan " + std::to_string(scan) + ", beam " +
                                     std::to_string(beam) +
                                     ": pose graphs have one reading per beam and evenly spaced "
                                     "beams");
    }
    (*readings)[beam] = ShortestDecimal(graph.returns().range_m[r]);
  }
  if (laser.bearing_step_rad < 0.0) std::reverse(readings->begin(), readings->end());
  return Status::Ok();
}

Status ScanText(const SlamGraph& graph, int scan, std::string* text) {
  const LaserModel& laser = graph.LaserOfScan(scan);
  CarmenScan record;
  PLUMBLINE_RETURN_IF_ERROR(ReadingsOf(graph, scan, &record.ranges));
  record.timestamp_s = graph.timestamp_s(graph.scan(scan).pose);
  record.odom_from_robot = graph.InitialPose(graph.scan(scan).pose);
  record.odom_from_laser = graph.WorldFromLaser(scan, graph.initial_poses());
  record.first_bearing_rad =
      laser.bearing_step_rad < 0.0 ? laser.Bearing(laser.num_beams - 1) : laser.first_bearing_rad;
  // A single beam has no step, but the record wants one.
  record.bearing_step_rad = laser.num_beams > 1 ? std::abs(laser.bearing_step_rad) : 1.0;
  record.max_range_m = laser.max_range_m;
  *text = RobotLaserRecord(record);
  return Status::Ok();
}

// The fields of an edge, words as they stand, in the order of another format.
std::string TranslateEdge(std::string_view line, const PoseGraphDialect& from,
                          const PoseGraphDialect& to) {
  FieldReader fields(line);
  fields.Word("keyword");
  std::string text = to.edge;
  for (const char* field : {"from", "to", "x", "y", "yaw"}) {
    text += ' ' + std::string(fields.Word(field));
  }
  std::array<std::string_view, 6> information;
  for (std::string_view& word : information) word = fields.Word("information");
  for (const std::string_view field : to.information) {
    const auto place = std::find(std::begin(from.information), std::end(from.information), field);
    text += ' ' + std::string(information[place - std::begin(from.information)]);
  }
  return text;
}

// The record of a vertex with this pose.
std::string TranslateVertex(std::string_view line, const Pose2& pose, const PoseGraphDialect& to) {
  FieldReader fields(line);
  fields.Word("keyword");
  const std::string id(fields.Word("id"));
  FieldReader rest = fields;
  const Pose2 read = ReadPoseFields(&fields);
  std::string text = to.vertex + (' ' + id);
  if (read.x != pose.x || read.y != pose.y || read.yaw != pose.yaw) {
    return text + PoseText({pose.x, pose.y, NormalizeAngle(pose.yaw)});
  }
  for (const char* field : {"x", "y", "yaw"}) text += ' ' + std::string(rest.Word(field));
  return text;
}

}  // namespace

Status MakePoseGraphFile(SlamGraph graph, const MotionOptions& motion, PoseGraphFile* file) {
  PoseGraphFile result;
  result.format = kWritten;
  std::vector<std::vector<int>> scans_of_pose(graph.num_poses());
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    scans_of_pose[graph.scan(scan).pose].push_back(scan);
  }
  const std::string vertex = DialectOf(kWritten).vertex;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    result.vertex_ids.push_back(pose);
    result.lines.push_back(vertex + ' ' + std::to_string(pose) + PoseText(graph.InitialPose(pose)));
    for (const int scan : scans_of_pose[pose]) {
      result.lines.emplace_back();
      PLUMBLINE_RETURN_IF_ERROR(ScanText(graph, scan, &result.lines.back()));
    }
  }
  for (const FixedPose& fixed : graph.fixed_poses()) {
    result.lines.push_back("FIX " + std::to_string(fixed.pose));
  }
  for (const OdometryConstraint& c : graph.odometry()) {
    result.lines.push_back(
        EdgeText(c.from, c.to, c.from_from_to, MotionCovariance(c.from_from_to, motion)));
  }
  for (const RelativePoseConstraint& c : graph.relative_poses()) {
    result.lines.push_back(EdgeText(c.from, c.to, c.from_from_to, c.covariance));
  }
  result.graph = std::move(graph);
  *file = std::move(result);
  return Status::Ok();
}

Status WritePoseGraphFile(const std::string& path, PoseGraphFormat format,
                          const PoseGraphFile& file, const std::vector<double>& poses) {
  AtomicFile output;
  PLUMBLINE_RETURN_IF_ERROR(output.Open(path));
  const PoseGraphDialect &from = DialectOf(file.format), &to = DialectOf(format);
  int pose = 0;
  for (const std::string& line : file.lines) {
    const std::string_view keyword = RecordKeyword(line);
    if (keyword == from.vertex) {
      output.stream() << TranslateVertex(line, Pose2(&poses[3 * pose++]), to) << '\n';
    } else if (keyword == from.edge && format != file.format) {
      output.stream() << TranslateEdge(line, from, to) << '\n';
    } else {
      output.stream() << line << '\n';
    }
  }
  return output.Commit();
}

}  // namespace plumbline
