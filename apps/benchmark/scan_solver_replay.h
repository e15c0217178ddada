#ifndef PLUMBLINE_APPS_BENCHMARK_SCAN_SOLVER_REPLAY_H_
#define PLUMBLINE_APPS_BENCHMARK_SCAN_SOLVER_REPLAY_H_

#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// One computation of a scan solver.
struct ScanSolverCall {
  int num_nodes = 0;  ///< that there are by then
  int num_edges = 0;  ///< likewise
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of all threads
};

struct ScanSolverReplay {
  std::vector<ScanSolverCall> calls;
  std::vector<Pose2> world_from_robot;  ///< after the last of them
};

/// Replays the calls that a mapper as karto makes to the scan solver of apps/slam_toolbox. Nodes
/// come in the order of the graph's poses, each where its first edge puts it; an edge comes with
/// the later of its nodes. The mapper computes after a node that closes a loop: one with an edge to
/// any other than the node before it. `done` is called after each computation.
///
/// graph: poses with one scan or none, and relative poses. InvalidArgument if it has several scans
/// at a pose or if no loop is closed, and what JointMap refuses; Unavailable if a computation
/// fails.
Status ReplayScanSolver(const SolverOptions& options, const SlamGraph& graph,
                        const std::function<void(const ScanSolverCall&)>& done,
                        ScanSolverReplay* replay);

/// For people: how many nodes, edges and computations there were, and how long these took.
std::string ScanSolverTable(const ScanSolverReplay& replay);

/// One line per computation. Unavailable if the file cannot be written.
Status WriteScanSolverCsv(const std::string& path, const ScanSolverReplay& replay);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_SCAN_SOLVER_REPLAY_H_
