#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/input_limits.h"
#include "plumbline/solvers/pose_graph/connected_poses.h"

namespace plumbline {
namespace {

// With its scope.
using SensorName = std::pair<std::string, std::string>;

SensorName SensorNameOf(const ArchiveObject& name) {
  return {std::string(name.String("scope")), std::string(name.String("name"))};
}

Status Fail(const std::string& path, const std::string& problem) {
  return Status::InvalidArgument(path + ": " + problem);
}

// Fills a graph step by step.
class SlamToolboxGraphBuilder {
 public:
  explicit SlamToolboxGraphBuilder(const SlamToolboxMap& map)
      : path_(map.path), data_path_(SlamToolboxFiles(map.path)[1]) {}

  // The first of a name counts, as for slam_toolbox.
  Status TakeLasers(const ArchiveObject& lasers) {
    for (std::size_t i = 0; i < lasers.size(); ++i) {
      if (!lasers[i].IsA("karto::LaserRangeFinder")) continue;
      const SensorName name = SensorNameOf(lasers[i].Object("base").Object("base").Object("name"));
      const auto [laser, is_new] = lasers_.emplace(name, LaserModel());
      if (is_new) PLUMBLINE_RETURN_IF_ERROR(ReadLaser(lasers[i], name, &laser->second));
    }
    return Status::Ok();
  }

  Status AddScan(const ArchiveObject& scan) {
    const std::string name = "scan " + std::to_string(ScanId(scan)) + ": ";
    const ArchiveObject readings = scan.Object("base"), sensor_data = readings.Object("base");
    const SensorName sensor = SensorNameOf(sensor_data.Object("sensor_name"));
    const auto laser = lasers_.find(sensor);
    if (laser == lasers_.end()) {
      return Fail(path_, name + "its laser " + Quote(sensor.second) + " is not in '" + data_path_ +
                             "'; do the files belong together?");
    }
    const auto num_readings = static_cast<std::size_t>(readings.Number("number_of_range_readings"));
    if (num_readings != static_cast<std::size_t>(laser->second.num_beams)) {
      return Fail(path_, name + std::to_string(num_readings) + " readings for a laser of " +
                             std::to_string(laser->second.num_beams) + " beams");
    }
    const int laser_id = graph_.AddLaser(laser->second);
    const int pose =
        graph_.AddPose(PoseOf(scan.Object("corrected_pose")), sensor_data.Number("time"));
    graph_.AddScan(pose, laser_id, readings.Numbers("range_readings"));
    PLUMBLINE_RETURN_IF_ERROR(StatusOf(name));
    if (!pose_of_scan_.emplace(ScanId(scan), pose).second) {
      return Fail(path_, name + "there are two of this id");
    }
    return AddOdometry(scan, sensor, pose, name);
  }

  Status AddEdge(const ArchiveObject& edge) {
    RelativePoseConstraint constraint;
    PLUMBLINE_RETURN_IF_ERROR(FindPose(edge.Object("source"), &constraint.from));
    PLUMBLINE_RETURN_IF_ERROR(FindPose(edge.Object("target"), &constraint.to));
    const ArchiveObject link = edge.Object("label");
    const std::string name =
        "edge " + ScanName(edge.Object("source")) + " -> " + ScanName(edge.Object("target")) + ": ";
    if (!link.IsA("karto::LinkInfo")) return Fail(path_, name + "it has no measurement");
    constraint.from_from_to = PoseOf(link.Object("pose_difference"));
    const ArchiveObject matrix = link.Object("covariance");
    for (const char* row : {"0", "1", "2"}) {
      const std::vector<double> numbers = matrix.Numbers(std::string("row_") + row);
      if (numbers.size() != 3) return Fail(path_, name + "its covariance is no 3 x 3 matrix");
      constraint.covariance.row(*row - '0') << numbers[0], numbers[1], numbers[2];
    }
    // Turned from the map into the frame of the scan, to rounding.
    constraint.covariance =
        (0.5 * (constraint.covariance + constraint.covariance.transpose())).eval();
    graph_.AddRelativePose(constraint);
    return StatusOf(name);
  }

  Status Finish(const std::vector<ArchiveObject>& scans, SlamGraph* graph, int* num_restarts) {
    if (graph_.num_poses() == 0) return Fail(path_, "the map has no scans");
    const int unconnected = FindUnconnectedPose(graph_, {0});
    if (unconnected >= 0) {
      return Fail(path_, "no edges connect scan " + std::to_string(ScanId(scans[unconnected])) +
                             " with the first scan, " + std::to_string(ScanId(scans[0])));
    }
    *graph = std::move(graph_);
    *num_restarts = num_restarts_;
    return Status::Ok();
  }

 private:
  struct LastScan {
    int pose = 0;
    Pose2 odom_from_robot;
  };

  Status ReadLaser(const ArchiveObject& finder, const SensorName& name, LaserModel* laser) const {
    const ArchiveObject offset = finder.Object("base").Object("offset_pose");
    bool is_whole = !offset.is_null();
    const auto parameter = [&](const char* member) {
      const ArchiveObject object = finder.Object(member);
      is_whole = is_whole && !object.is_null();
      return object.is_null() ? 0.0 : object.Number("value");
    };
    laser->num_beams =
        static_cast<int>(std::min(finder.Number("number_of_range_readings"), 1.0 * kMaxBeams));
    laser->first_bearing_rad = parameter("minimum_angle");
    laser->bearing_step_rad = parameter("angular_resolution");
    laser->min_range_m = std::max(laser->min_range_m, parameter("minimum_range"));
    laser->max_range_m = std::min(parameter("maximum_range"), parameter("range_threshold"));
    if (is_whole) laser->robot_from_laser = PoseOf(offset.Object("value"));
    std::string error = "a parameter is missing";
    if (is_whole && laser->Check(&error)) return Status::Ok();
    return Fail(data_path_, "laser " + Quote(name.second) + ": " + error);
  }

  Status AddOdometry(const ArchiveObject& scan, const SensorName& sensor, int pose,
                     const std::string& name) {
    constexpr double kMaxDifferenceM = 1.0, kMaxDifferenceRad = DegToRad(45.0);
    const Pose2 odom_from_robot = PoseOf(scan.Object("odometric_pose"));
    if (!IsWithinLimits(odom_from_robot)) {
      return Fail(path_, name + "its odometric pose is not finite, or beyond all limits");
    }
    const auto [last, is_first] = last_scans_.emplace(sensor, LastScan());
    const LastScan before = std::exchange(last->second, {pose, odom_from_robot});
    if (is_first) return Status::Ok();
    const Pose2 step = Between(before.odom_from_robot, odom_from_robot);
    const Pose2 difference =
        Between(Between(graph_.InitialPose(before.pose), graph_.InitialPose(pose)), step);
    if (std::hypot(difference.x, difference.y) > kMaxDifferenceM ||
        std::abs(NormalizeAngle(difference.yaw)) > kMaxDifferenceRad) {
      ++num_restarts_;
      return Status::Ok();
    }
    graph_.AddOdometry({before.pose, pose, step});
    return StatusOf(name);
  }

  // The error of the last measurement, by this name.
  Status StatusOf(const std::string& name) const {
    const Status& status = graph_.status();
    return status.ok() ? status : Fail(path_, name + status.message());
  }

  static std::string ScanName(const ArchiveObject& vertex) {
    const ArchiveObject scan = vertex.is_null() ? vertex : vertex.Object("object");
    return scan.is_null() ? "none" : std::to_string(ScanId(scan));
  }

  Status FindPose(const ArchiveObject& vertex, int* pose) const {
    const ArchiveObject scan = vertex.is_null() ? vertex : vertex.Object("object");
    const auto known = scan.is_null() ? pose_of_scan_.end() : pose_of_scan_.find(ScanId(scan));
    if (known == pose_of_scan_.end()) {
      return Fail(path_, "an edge leads to scan " + ScanName(vertex) + ", which is no vertex");
    }
    *pose = known->second;
    return Status::Ok();
  }

  // More are refused by the model's check.
  static constexpr int kMaxBeams = 1000000;

  const std::string path_, data_path_;
  SlamGraph graph_;
  std::map<SensorName, LaserModel> lasers_;
  std::map<SensorName, LastScan> last_scans_;
  std::unordered_map<int, int> pose_of_scan_;
  int num_restarts_ = 0;
};

}  // namespace

Status BuildGraph(const SlamToolboxMap& map, SlamGraph* graph, int* num_restarts) {
  SlamToolboxGraphBuilder builder(map);
  const std::vector<ArchiveObject> scans = GraphScansOf(map);
  PLUMBLINE_RETURN_IF_ERROR(builder.TakeLasers(map.dataset.root().Object("lasers")));
  for (const ArchiveObject& scan : scans) PLUMBLINE_RETURN_IF_ERROR(builder.AddScan(scan));
  for (const ArchiveObject& edge : GraphEdgesOf(map)) {
    PLUMBLINE_RETURN_IF_ERROR(builder.AddEdge(edge));
  }
  return builder.Finish(scans, graph, num_restarts);
}

}  // namespace plumbline
