#ifndef PLUMBLINE_APPS_BENCHMARK_MAPPER_RECORD_H_
#define PLUMBLINE_APPS_BENCHMARK_MAPPER_RECORD_H_

#include <string>
#include <vector>

#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a mapper as karto made of a drive, and what its map can be measured by.
struct MapperRecord {
  SlamGraph graph;                  ///< nodes in the order in which they were made, and its edges
  std::vector<Pose2> truth;         ///< of the nodes; empty: unknown
  CarmenLog log;                    ///< all scans of the drive, nodes or not; may be empty
  std::vector<Relation> relations;  ///< between times of the log; may be empty
};

/// A mapper with a node every 1.2 s of a simulated drive, that closes one of ten loops
/// falsely.
Status SimulateMapper(MapperRecord* record);

/// Reads a pose graph with scans, and the log and the relations where their paths are not empty.
/// Fails as their readers do.
Status ReadMapper(const std::string& graph, const std::string& log, const std::string& relations,
                  MapperRecord* record);

/// A pose for every scan of the log from the first node on: that of the last node, moved along the
/// log's odometry. nodes: by time, at the times of scans of the log.
std::vector<TimedPose> MovedAlongOdometry(const std::vector<TimedPose>& nodes,
                                          const CarmenLog& log);

/// For people: errors of the nodes after the best rigid fit, or those of all scans by the
/// relations; empty if neither is known.
std::string MapperErrors(const MapperRecord& record, const std::vector<Pose2>& world_from_robot);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_MAPPER_RECORD_H_
