#include "plumbline/apps/io/pose_graph_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/number_text.h"
#include "plumbline/apps/io/pose_graph_records.h"
#include "plumbline/apps/io/robot_laser_record.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/over_peers.h"
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
      return Status::InvalidArgument("scan " + std::to_string(graph.IdAmongAll(scan)) + ", beam " +
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

std::vector<std::vector<int>> ScansOfPoses(const SlamGraph& graph) {
  std::vector<std::vector<int>> scans_of_pose(graph.num_poses());
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    scans_of_pose[graph.scan(scan).pose].push_back(scan);
  }
  return scans_of_pose;
}

// Keeps the yaw of a pose that did not move as it is.
std::string MovedPoseText(const Pose2& before, const Pose2& pose) {
  const bool has_moved = before.x != pose.x || before.y != pose.y || before.yaw != pose.yaw;
  return PoseText({pose.x, pose.y, has_moved ? NormalizeAngle(pose.yaw) : pose.yaw});
}

std::string VertexText(const SlamGraph& graph, int id, const Pose2& pose) {
  return DialectOf(kWritten).vertex + (' ' + std::to_string(id)) +
         MovedPoseText(graph.InitialPose(id), pose);
}

// Calls take(line) for all that comes after the vertices.
template <typename Take>
void ForEachConstraint(const SlamGraph& graph, const MotionOptions& motion, const Take& take) {
  for (const FixedPose& fixed : graph.fixed_poses()) take("FIX " + std::to_string(fixed.pose));
  for (const OdometryConstraint& c : graph.odometry()) {
    take(EdgeText(c.from, c.to, c.from_from_to, MotionCovariance(c.from_from_to, motion)));
  }
  for (const RelativePoseConstraint& c : graph.relative_poses()) {
    take(EdgeText(c.from, c.to, c.from_from_to, c.covariance));
  }
}

// The records of the scans of poses that follow each other, each pose's together, to be written
// where process 0 is.
class ScanRecords {
 public:
  explicit ScanRecords(const SlamGraph& graph)
      : graph_(graph), scans_of_pose_(ScansOfPoses(graph)) {}

  // (*records)[i]: of pose first + i. Collective.
  Status Of(int first, int end, std::vector<std::string>* records) const {
    records->assign(end - first, "");
    PLUMBLINE_RETURN_IF_ERROR(FirstFailure(graph_.peers(), MakeOwn(first, records)));
    if (graph_.peers() != nullptr) BringTogether(first, records);
    return Status::Ok();
  }

 private:
  Status MakeOwn(int first, std::vector<std::string>* records) const {
    std::string line;
    for (std::size_t i = 0; i < records->size(); ++i) {
      for (const int scan : scans_of_pose_[first + i]) {
        PLUMBLINE_RETURN_IF_ERROR(ScanText(graph_, scan, &line));
        (*records)[i] += line + '\n';
      }
    }
    return Status::Ok();
  }

  void BringTogether(int first, std::vector<std::string>* records) const {
    const Peers& peers = *graph_.peers();
    std::vector<std::vector<std::size_t>> sizes(peers.size());
    std::vector<std::vector<char>> text(peers.size());
    for (std::size_t i = 0; i < records->size(); ++i) {
      if (!graph_.HasScansOf(first + static_cast<int>(i))) continue;
      sizes[0].push_back((*records)[i].size());
      text[0].insert(text[0].end(), (*records)[i].begin(), (*records)[i].end());
    }
    sizes = ExchangeValues(peers, sizes);
    text = peers.Exchange(text);
    if (!SpeaksForAll(&peers)) return;
    std::vector<std::size_t> next_size(peers.size(), 0), next_char(peers.size(), 0);
    for (std::size_t i = 0; i < records->size(); ++i) {
      const int rank = graph_.rank_of_pose()[first + i];
      const std::size_t size = sizes[rank][next_size[rank]++];
      (*records)[i].assign(text[rank].data() + next_char[rank], size);
      next_char[rank] += size;
    }
  }

  const SlamGraph& graph_;
  std::vector<std::vector<int>> scans_of_pose_;
};

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
  const std::vector<std::vector<int>> scans_of_pose = ScansOfPoses(graph);
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    result.vertex_ids.push_back(pose);
    result.lines.push_back(VertexText(graph, pose, graph.InitialPose(pose)));
    for (const int scan : scans_of_pose[pose]) {
      result.lines.emplace_back();
      PLUMBLINE_RETURN_IF_ERROR(ScanText(graph, scan, &result.lines.back()));
    }
  }
  ForEachConstraint(graph, motion,
                    [&](std::string line) { result.lines.push_back(std::move(line)); });
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

Status WritePoseGraph(const std::string& path, const SlamGraph& graph, const MotionOptions& motion,
                      const std::vector<RelativePoseConstraint>& more_edges,
                      const std::vector<double>& poses) {
  constexpr int kPosesAtATime = 500;
  AtomicFile output;
  PLUMBLINE_RETURN_IF_ERROR(BySpeaker(graph.peers(), [&] { return output.Open(path); }));
  std::ostream& stream = output.stream();
  const ScanRecords records(graph);
  std::vector<std::string> of_poses;
  for (int first = 0; first < graph.num_poses(); first += kPosesAtATime) {
    const int end = std::min(first + kPosesAtATime, graph.num_poses());
    PLUMBLINE_RETURN_IF_ERROR(records.Of(first, end, &of_poses));
    if (!SpeaksForAll(graph.peers())) continue;
    for (int pose = first; pose < end; ++pose) {
      stream << VertexText(graph, pose, Pose2(&poses[3 * pose])) << '\n' << of_poses[pose - first];
    }
  }
  return BySpeaker(graph.peers(), [&] {
    ForEachConstraint(graph, motion, [&](const std::string& line) { stream << line << '\n'; });
    for (const RelativePoseConstraint& c : more_edges) {
      stream << EdgeText(c.from, c.to, c.from_from_to, c.covariance) << '\n';
    }
    return output.Commit();
  });
}

}  // namespace plumbline
