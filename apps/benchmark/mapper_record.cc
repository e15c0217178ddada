#include "plumbline/apps/benchmark/mapper_record.h"

#include <iomanip>
#include <sstream>
#include <utility>

#include "plumbline/apps/benchmark/mapper_edges.h"
#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/readers/pose_graph_input.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/map_state.h"

namespace plumbline {

Status SimulateMapper(MapperRecord* record) {
  SimulationOptions options;
  options.scan_period_s = 1.2;
  SimulatedLog log;
  PLUMBLINE_RETURN_IF_ERROR(
      Simulate(World(GenerateBuilding(BuildingKind::kRandom, 1)), options, &log));
  SlamGraph drive;
  PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, &drive));
  MapperRecord result;
  for (const SimulatedScan& scan : log.scans) result.truth.push_back(scan.world_from_robot);
  for (int pose = 0; pose < drive.num_poses(); ++pose) {
    result.graph.AddPose(result.truth[pose], drive.timestamp_s(pose));
    result.graph.AddScanOf(drive, pose, pose);
  }
  constexpr double kFalseShare = 0.1;
  NoiseSource source(1, 0);
  for (const RelativePoseConstraint& edge :
       MakeMapperEdges(result.truth, FalseClosures::kGross, kFalseShare, &source).edges) {
    result.graph.AddRelativePose(edge);
  }
  *record = std::move(result);
  return record->graph.status();
}

Status ReadMapper(const std::string& graph, const std::string& log, const std::string& relations,
                  MapperRecord* record) {
  MapperRecord result;
  PoseGraphInput input;
  PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraph(graph, 0.0, &input));
  result.graph = std::move(input.graph);
  if (!log.empty()) PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(log, CarmenReadOptions(), &result.log));
  if (!relations.empty()) PLUMBLINE_RETURN_IF_ERROR(ReadRelations(relations, &result.relations));
  *record = std::move(result);
  return Status::Ok();
}

std::vector<TimedPose> MovedAlongOdometry(const std::vector<TimedPose>& nodes,
                                          const CarmenLog& log) {
  constexpr double kSameTimeS = 1e-6;  // times are written with six decimals
  std::vector<TimedPose> trajectory;
  Pose2 world_from_odometry;
  auto node = nodes.begin();
  for (const CarmenScan& scan : log.scans) {
    while (node != nodes.end() && node->timestamp_s <= scan.timestamp_s + kSameTimeS) {
      world_from_odometry = node->world_from_robot * scan.odom_from_robot.Inverse();
      ++node;
    }
    if (node == nodes.begin()) continue;
    trajectory.push_back({scan.timestamp_s, world_from_odometry * scan.odom_from_robot});
  }
  return trajectory;
}

std::string MapperErrors(const MapperRecord& record, const std::vector<Pose2>& world_from_robot) {
  std::ostringstream text;
  PoseErrorStatistics statistics;
  if (!record.truth.empty()) {
    PoseErrors errors(StatisticsConvention::kFreiburg);
    errors.AddFitted(record.truth, world_from_robot);
    statistics = errors.Statistics();
    text << "nodes:     ";
  } else if (!record.relations.empty()) {
    MapState state;
    state.poses = PoseArray(world_from_robot);
    const std::vector<TimedPose> trajectory =
        MovedAlongOdometry(TrajectoryOf(record.graph, state), record.log);
    statistics = MeasureRelations(record.relations, trajectory, RelationsOptions()).all;
    text << "relations: ";
  } else {
    return "";
  }
  text << std::fixed << std::setprecision(4) << statistics.translation_m.mean << " +- "
       << statistics.translation_m.std << " m, " << std::setprecision(3)
       << statistics.rotation_deg.mean << " +- " << statistics.rotation_deg.std << " deg ("
       << statistics.num_matched << ")\n";
  return text.str();
}

}  // namespace plumbline
