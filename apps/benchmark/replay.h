#ifndef PLUMBLINE_APPS_BENCHMARK_REPLAY_H_
#define PLUMBLINE_APPS_BENCHMARK_REPLAY_H_

#include <functional>
#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/incremental_solver.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/sliding_window.h"

namespace plumbline {

/// What refines the map while it grows.
enum class OnlineSolver {
  kIncremental,  ///< IncrementalSolver; closures are relative poses of the graph
  kWindow,       ///< SolveWindow; where closures are news, a pose graph, then Solve
};
bool FromString(const std::string& name, OnlineSolver* solver);

/// How a host that maps while driving is replayed.
struct ReplayOptions {
  OnlineSolver online_solver = OnlineSolver::kIncremental;
  int batch_poses = 10;  ///< that arrive between two solves
  /// A closure is news if its squared Mahalanobis length at the current poses is above this; of
  /// closures that these poses agree with, one of a thousand is (three degrees of freedom).
  double max_closure_chi2 = 16.27;
  IncrementalOptions incremental;
  WindowOptions window;

  bool Check(std::string* error) const;
};

enum class ReplayedSolve {
  kWindow,  ///< the newest poses
  kLoops,   ///< a closure was news: all poses
  kFinal,   ///< all poses and points, once more at the end of the drive
};
const char* ToString(ReplayedSolve solve);

/// One solve, and when it took place.
struct ReplayStep {
  int batch = 0;  ///< from 1; the final solve has that of the last one
  int num_poses = 0;
  ReplayedSolve solve = ReplayedSolve::kWindow;
  int num_closures = 0;  ///< that have arrived
  int num_news = 0;      ///< of these, with this batch and not as the poses had it
  int num_placed = 0;    ///< poses whose returns IncrementalSolver associated, first or anew
  double time_s = 0.0;   ///< pose graph included
  /// Of what was solved, before and after: comparable with each other alone.
  double initial_energy = 0.0;
  double final_energy = 0.0;
};

/// Differences between the poses of two maps of one drive that share their first pose.
struct PoseDifferences {
  double mean_m = 0.0;        ///< of the positions
  double max_m = 0.0;         ///< of the positions
  double max_turn_rad = 0.0;  ///< of the change of heading from one pose to the next: a kink
};

/// batch: the reference.
PoseDifferences ComparePoses(const std::vector<Pose2>& poses, const std::vector<Pose2>& batch);

struct Replay {
  std::vector<ReplayStep> steps;
  std::vector<Pose2> world_from_robot;  ///< the map of the host, before the final solve
  /// All at once, from the seed.
  double batch_time_s = 0.0;
  /// MarginalEnergy of the whole drive.
  double batch_energy = 0.0;
  double online_energy = 0.0;  ///< before the final solve
  double final_energy = 0.0;   ///< after it
  /// @{
  /// From the batch solution: before and after the final solve.
  PoseDifferences online_difference;
  PoseDifferences final_difference;
  /// @}

  /// Final energy over that of the batch solution.
  double EnergyRatio() const { return final_energy / batch_energy; }
};

/// Replays a drive whose scans have been matched: poses arrive with their scans and odometry,
/// chained to the last refined pose by the sequential matching. A closure arrives with the later of
/// its poses. What is timed is the back end: matching and search for closures are not.
///
/// drive: the whole of it, one pose after the other, and its scans in the order of the poses. seed
/// and report: as SeedGraph gave them. `done` is called after each step. InvalidArgument on bad
/// options and a report of another graph, Unavailable if a solve fails.
Status RunReplay(const SolverOptions& solver, const ReplayOptions& options, const SlamGraph& drive,
                 const MapState& seed, const SeedingReport& report,
                 const std::function<void(const ReplayStep&)>& done, Replay* replay);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_REPLAY_H_
