#ifndef PLUMBLINE_APPS_RUN_POSE_GRAPH_RUN_H_
#define PLUMBLINE_APPS_RUN_POSE_GRAPH_RUN_H_

#include <string>

#include "plumbline/apps/run/memory_estimate.h"
#include "plumbline/apps/run/run_outputs.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

struct PoseGraphRunOptions {
  std::string log;
  std::string output_dir;
  RunOutputOptions outputs;
  SolverOptions solver;
  double max_memory = 0.0;  ///< what needs more by estimate is refused [bytes]; 0: no limit
  /// Processes that run with the same options and share the work once process 0 has read the graph,
  /// which needs scans then; null: this one does it all.
  const Peers* peers = nullptr;
  SeedingOptions seeding;  ///< where the scans have to give the start
};

/// Refines a pose graph that another system has saved: by its edges alone, then, if scans are
/// attached to its vertices, by edges and scans together; or, with options that MovesPosesOnly(),
/// by nothing but the edges. A map that contradicts itself is seeded by its scans, which must be in
/// order of time, one per pose. Prints what happens; leaves in the output
/// folder
///   trajectory.tum      pose of the robot per vertex; time of its scan, or else its index
///   graph.g2o or .toro  the file that came in, with the refined poses
///   summary.json        figures
/// and with scans also report.html, what MapWriteTasks names and a picture of each stage; if they
/// are in order of time, it is measured whether the map contradicts itself (conflicts.png), with a
/// warning on standard error if the refined map does. A stop signal (stop_signal.h) ends the
/// optimisation once the graph is read: what it leaves is the best state so far. A failed Status
/// names the culprit.
Status RunPoseGraph(const PoseGraphRunOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_POSE_GRAPH_RUN_H_
