#include "plumbline/apps/benchmark/scan_solver_replay.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/slam_toolbox/joint_map.h"
#include "plumbline/core/seconds_since.h"

namespace plumbline {
namespace {

constexpr double kNoReturn = std::numeric_limits<double>::infinity();

// The edges of each pose with earlier ones.
using ArrivingEdges = std::vector<std::vector<RelativePoseConstraint>>;

ArrivingEdges EdgesByArrival(const SlamGraph& graph) {
  ArrivingEdges edges(graph.num_poses());
  for (const RelativePoseConstraint& edge : graph.relative_poses()) {
    edges[std::max(edge.from, edge.to)].push_back(edge);
  }
  return edges;
}

Status ScansByPose(const SlamGraph& graph, std::vector<int>* scans) {
  scans->assign(graph.num_poses(), -1);
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    int& of_pose = (*scans)[graph.scan(scan).pose];
    if (of_pose >= 0) {
      return Status::InvalidArgument("pose " + std::to_string(graph.scan(scan).pose) +
                                     " has several scans, a node of a mapper has one");
    }
    of_pose = scan;
  }
  return Status::Ok();
}

// What a mapper does with its solver.
class ReplayedMapper {
 public:
  ReplayedMapper(const SolverOptions& options, const SlamGraph& graph)
      : graph_(graph), edges_(EdgesByArrival(graph)), map_(options) {}

  Status AddNode(int pose, int scan) {
    PLUMBLINE_RETURN_IF_ERROR(map_.AddNode(pose, Start(pose), graph_.timestamp_s(pose)));
    if (scan >= 0) {
      PLUMBLINE_RETURN_IF_ERROR(
          map_.SetScan(pose, graph_.LaserOfScan(scan), graph_.RangesOfScan(scan, kNoReturn)));
    }
    for (const RelativePoseConstraint& edge : edges_[pose]) {
      PLUMBLINE_RETURN_IF_ERROR(
          map_.AddConstraint(edge.from, edge.to, edge.from_from_to, edge.covariance));
      ++num_edges_;
    }
    return Status::Ok();
  }

  bool ClosesLoop(int pose) const {
    return std::any_of(edges_[pose].begin(), edges_[pose].end(),
                       [pose](const RelativePoseConstraint& edge) {
                         return std::min(edge.from, edge.to) != pose - 1;
                       });
  }

  Status Compute(int num_nodes, ScanSolverCall* call) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    PLUMBLINE_RETURN_IF_ERROR(map_.Estimate());
    call->cpu_s = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    call->wall_s = SecondsSince(start);
    call->num_nodes = num_nodes;
    call->num_edges = num_edges_;
    return Status::Ok();
  }

  Pose2 PoseOf(int pose) const { return *map_.FindPose(pose); }

 private:
  Pose2 Start(int pose) const {
    if (edges_[pose].empty()) return graph_.InitialPose(pose);
    const RelativePoseConstraint& edge = edges_[pose].front();
    return edge.to == pose ? PoseOf(edge.from) * edge.from_from_to
                           : PoseOf(edge.to) * edge.from_from_to.Inverse();
  }

  const SlamGraph& graph_;
  const ArrivingEdges edges_;
  JointMap map_;
  int num_edges_ = 0;
};

// Mean and worst of what `of` takes of the calls, in milliseconds.
template <typename Of>
std::string Milliseconds(const std::vector<ScanSolverCall>& calls, const Of& of) {
  double sum_s = 0.0, worst_s = 0.0;
  for (const ScanSolverCall& call : calls) {
    sum_s += of(call);
    worst_s = std::max(worst_s, of(call));
  }
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "mean " << 1e3 * sum_s / calls.size()
       << " ms, worst " << 1e3 * worst_s << " ms";
  return text.str();
}

}  // namespace

Status ReplayScanSolver(const SolverOptions& options, const SlamGraph& graph,
                        const std::function<void(const ScanSolverCall&)>& done,
                        ScanSolverReplay* replay) {
  std::vector<int> scans;
  PLUMBLINE_RETURN_IF_ERROR(ScansByPose(graph, &scans));
  ReplayedMapper mapper(options, graph);
  ScanSolverReplay result;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    PLUMBLINE_RETURN_IF_ERROR(mapper.AddNode(pose, scans[pose]));
    if (!mapper.ClosesLoop(pose)) continue;
    ScanSolverCall call;
    PLUMBLINE_RETURN_IF_ERROR(mapper.Compute(pose + 1, &call));
    result.calls.push_back(call);
    if (done) done(call);
  }
  if (result.calls.empty()) return Status::InvalidArgument("the graph closes no loop");
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    result.world_from_robot.push_back(mapper.PoseOf(pose));
  }
  *replay = std::move(result);
  return Status::Ok();
}

std::string ScanSolverTable(const ScanSolverReplay& replay) {
  const ScanSolverCall& last = replay.calls.back();
  std::ostringstream text;
  text << replay.calls.size() << " computations, the last with " << last.num_nodes << " nodes and "
       << last.num_edges << " edges\n"
       << "wall time: "
       << Milliseconds(replay.calls, [](const ScanSolverCall& call) { return call.wall_s; })
       << "\nCPU time:  "
       << Milliseconds(replay.calls, [](const ScanSolverCall& call) { return call.cpu_s; }) << '\n';
  return text.str();
}

Status WriteScanSolverCsv(const std::string& path, const ScanSolverReplay& replay) {
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  std::ostream& out = file.stream();
  out << "nodes,edges,wall_s,cpu_s\n" << std::setprecision(9);
  for (const ScanSolverCall& call : replay.calls) {
    out << call.num_nodes << ',' << call.num_edges << ',' << call.wall_s << ',' << call.cpu_s
        << '\n';
  }
  return file.Commit();
}

}  // namespace plumbline
