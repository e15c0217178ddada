#ifndef PLUMBLINE_SOLVERS_INCREMENTAL_SOLVER_H_
#define PLUMBLINE_SOLVERS_INCREMENTAL_SOLVER_H_

#include <memory>
#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/alarm.h"
#include "plumbline/solvers/interface/acceptance.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// How a graph is refined while it grows.
struct IncrementalOptions {
  /// The newest poses that an update moves; all new ones in any case. Several times as many as
  /// arrive between two updates, so that each is refined again once its surroundings have been seen
  /// from further on.
  int num_free_poses = 40;
  /// Cuts of the surfaces into landmarks per update, at most, each with a Gauss-Newton step.
  int max_rounds = 2;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// What an update did.
struct IncrementalSummary {
  int num_free_poses = 0;    ///< that could move
  int num_placed_poses = 0;  ///< whose returns were associated, for the first time or anew
  int num_rounds = 0;        ///< cuts of the surfaces
  int num_steps = 0;         ///< Gauss-Newton steps
  /// Of the free poses' landmarks and constraints, before the last step, at fixed weights.
  double initial_cost = 0.0;
  double final_cost = 0.0;  ///< the same after it
  /// The relative poses that the scans of their poses contradict, see SolverOptions::test_edges:
  /// all that are left out so far.
  std::vector<IgnoredEdge> ignored_edges;
  /// The loop closures in force (relative poses between poses that do not follow each other) that
  /// the result is farther off than one in a thousand right ones: they are false, or the map is
  /// wrong there.
  std::vector<IgnoredEdge> contradicted_closures;
  /// At most one, if more closures contradict the map, in force or ignored, than are usually false.
  std::vector<Alarm> alarms;
  double association_time_s = 0.0;   ///< testing edges, placing, cutting, weighing
  double minimization_time_s = 0.0;  ///< the steps
  double total_time_s = 0.0;         ///< of the update
};

/// Which poses an update may move.
enum class UpdateScope {
  /// The newest ones; all of them if the caller has moved older ones, or if a new relative pose
  /// that reaches back beyond the newest ones (a loop closure) contradicts the map, or is the first
  /// for a tenth of the drive.
  kAutomatic,
  kAll,  ///< all poses
};

/// Refines a graph while it grows: for robots that map while they drive, and for mappers that ask
/// for corrections again and again. Poses are estimated like the reduced solver does it, with
/// points and tangent lines eliminated. Landmarks and what the poses saw of them are kept between
/// updates. So the time of an update of the newest poses does not grow with the map, but for the
/// number of poses that saw the same surfaces; an update of all poses goes through the landmarks,
/// and only returns of poses that have moved are associated anew.
///
/// New returns join what lies where they end. So the drift has to stay below the distance between
/// surfaces that are not the same, a metre or two, until a relative pose closes the loop: after a
/// longer way around, close it before updates go on in the old part of the map.
///
/// Relative poses are tested by their scans when they come, as Solve does. There is no acceptance
/// test of the result; an alarm says so if many loop closures contradict it. Shape terms and
/// down-weighted steps are refused. Custom factors that see poses only are served. Where they hold
/// the map in the world, each update with new ones first moves the map as a whole to where they
/// want it.
///
/// Not for several threads at once; several objects are.
class IncrementalSolver {
 public:
  /// Of `solver`, what says how returns are associated and weighed counts: factors, test_edges,
  /// association, reduced and num_threads. Bad options are reported by the first update.
  explicit IncrementalSolver(const SolverOptions& solver = SolverOptions(),
                             const IncrementalOptions& options = IncrementalOptions());
  ~IncrementalSolver();
  IncrementalSolver(IncrementalSolver&&) noexcept;             ///< with all that is kept
  IncrementalSolver& operator=(IncrementalSolver&&) noexcept;  ///< likewise

  /// Takes in what the graph has gained since the last call, and refines *poses, (x, y [m], yaw
  /// [rad]) each. The graph has to be the one of the last call, grown or not. New poses have to be
  /// given where odometry or a matcher puts them, seen from the refined poses before them: within a
  /// few decimetres. Older poses that differ from what the last update gave have been moved by the
  /// caller: all poses are estimated anew from there. Fixed poses stay where the graph fixes them.
  ///
  /// InvalidArgument on bad options, a graph that has shrunk or refused a measurement, custom
  /// factors that see points or are not finite at the poses, or poses that are null, of another
  /// number, not finite or beyond 1e8, and if the solver has been moved from; nothing has changed
  /// then. Unavailable if memory runs out: *poses is as it was, and the next update begins from
  /// scratch.
  Status Update(const SlamGraph& graph, UpdateScope scope, std::vector<double>* poses,
                IncrementalSummary* summary = nullptr);

  /// The map at the poses of the last update: these, and every map point where its beam and its
  /// tangent line put it. Goes through all returns. The graph has to be the one of the last update,
  /// not grown; InvalidArgument if it is not, on null, and if the solver has been moved from.
  Status GetState(const SlamGraph& graph, MapState* state) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INCREMENTAL_SOLVER_H_
