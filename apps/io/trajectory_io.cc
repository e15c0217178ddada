#include "plumbline/apps/io/trajectory_io.h"

#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

TimedPose ReadPose(FieldReader* fields) {
  TimedPose pose;
  pose.timestamp_s = fields->Time("t");
  pose.world_from_robot.x = fields->Coordinate("x");
  pose.world_from_robot.y = fields->Coordinate("y");
  fields->Coordinate("z");
  const double qx = fields->FiniteNumber("qx"), qy = fields->FiniteNumber("qy");
  const double qz = fields->FiniteNumber("qz"), qw = fields->FiniteNumber("qw");
  fields->ExpectEnd();
  const double norm = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
  if (std::abs(norm - 1.0) > 0.01) {
    fields->Fail("qw", "the quaternion's norm is " + std::to_string(norm) + ", not 1");
  }
  // Heading of the robot's x axis in the plane; the norm cancels.
  pose.world_from_robot.yaw =
      std::atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz);
  return pose;
}

}  // namespace

std::vector<TimedPose> TrajectoryOf(const SlamGraph& graph, const MapState& state) {
  std::vector<TimedPose> trajectory;
  trajectory.reserve(state.num_poses());
  for (int pose = 0; pose < state.num_poses(); ++pose) {
    trajectory.push_back({graph.timestamp_s(pose), state.WorldFromRobot(pose)});
  }
  return trajectory;
}

Status WriteTumTrajectory(const std::string& path, const std::vector<TimedPose>& trajectory) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  for (const TimedPose& pose : trajectory) {
    const double half_yaw = 0.5 * NormalizeAngle(pose.world_from_robot.yaw);
    char line[1024];  // Holds four numbers of the largest magnitude a double has.
    const int length = std::snprintf(
        line, sizeof(line), "%.6f %.9f %.9f 0 0 0 %.9f %.9f\n", pose.timestamp_s,
        pose.world_from_robot.x, pose.world_from_robot.y, std::sin(half_yaw), std::cos(half_yaw));
    file.stream().write(line, length);
  }
  return file.Commit();
}

Status ReadTumTrajectory(const std::string& path, std::vector<TimedPose>* trajectory) {
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  std::vector<TimedPose> result;
  std::string_view line;
  while (reader.NextLine(&line)) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == line.npos || line[first] == '#') continue;
    FieldReader fields(line);
    result.push_back(ReadPose(&fields));
    if (!fields.ok()) {
      return Status::InvalidArgument(path + ":" + std::to_string(reader.line_number()) + ": " +
                                     fields.error());
    }
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.CheckWhole());
  if (result.empty()) return Status::InvalidArgument(path + ": no pose");
  *trajectory = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
