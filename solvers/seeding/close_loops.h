#ifndef PLUMBLINE_SOLVERS_SEEDING_CLOSE_LOOPS_H_
#define PLUMBLINE_SOLVERS_SEEDING_CLOSE_LOOPS_H_

#include <algorithm>
#include <cmath>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/seeding/closure_memory.h"
#include "plumbline/solvers/seeding/key_graph.h"
#include "plumbline/solvers/seeding/loop_acceptance.h"
#include "plumbline/solvers/seeding/loop_closure.h"
#include "plumbline/solvers/seeding/sequential_seeding.h"

namespace plumbline {

/// A match of two places, by the poses of the graph, and what became of it.
struct LoopClosureRecord {
  int from_pose = 0;
  int to_pose = 0;
  Pose2 from_from_to;
  ClosureVerdict verdict = ClosureVerdict::kAccepted;
};

/// A place of the path where the scans before and after it disagreed.
struct DoubtfulStep {
  int first_pose_after = 0;
  double evidence = 0.0;  ///< of the disagreement, from 0.15 to 1.6
  bool broken = false;    ///< the step was wrong; closures across it put it right
  /// How far the repair has turned what lies beyond it [rad]. Many buildings look alike turned by a
  /// right angle or half a turn, and nothing but the odometry says which it was.
  double turned_rad = 0.0;
  int num_closures_across = 0;
  /// Other places where what lies beyond it would contradict the map as little.
  int num_alternatives = 0;

  /// It looks wrong, and nothing else says for certain how what lies before and after it is tied
  /// together.
  bool IsUnresolved() const {
    return num_alternatives > 0 || std::abs(turned_rad) > kMaxCertainTurnRad ||
           ((broken || evidence >= kUntrustedEvidence) &&
            num_closures_across < LoopAcceptance::kMinClosuresAcross);
  }
  /// Far from a right angle, and more than a step that is merely off. Not tuned.
  static constexpr double kMaxCertainTurnRad = 0.5;
};

struct LoopClosingReport {
  int num_candidates = 0;    ///< places tried, over all rounds
  int num_closures = 0;      ///< accepted and kept
  int num_contradicted = 0;  ///< accepted first, then contradicted by the pose graph
  /// Every match that became a closure, was contradicted, or was refused: next to a doubtful edge,
  /// where matches are tried once, or in the last round, which tries the others anew.
  std::vector<LoopClosureRecord> matches;
  std::vector<DoubtfulStep> doubts;  ///< in order of time

  /// Whether a doubtful step is left that nothing settles.
  bool IsUnresolved() const {
    return std::any_of(doubts.begin(), doubts.end(),
                       [](const DoubtfulStep& doubt) { return doubt.IsUnresolved(); });
  }
};

/// The pose graph of a trajectory's key scans, as the sequential matching left it, without
/// closures.
KeyGraph MakeKeyGraph(const SequentialTrajectory& trajectory, const MotionOptions& motion);

/// Looks for closures, adds them and moves the key scans to the optimum of the pose graph, in
/// rounds: each finds what the one before has brought into reach. Closures that the others
/// contradict are dropped again. Closures that the graph has already are kept, as long as nothing
/// contradicts them; what it has refused is not found again. memory: of all that was tested for
/// these key scans so far; grows. Unavailable if progress stopped it.
Status CloseLoops(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                  const SeedingProgress& progress, ThreadPool* pool, ClosureMemory* memory,
                  KeyGraph* keys, LoopClosingReport* report);

/// Moves the key scans to the robust optimum of the graph's edges and closures.
void OptimizeKeyScans(KeyGraph* keys);

/// Carries every pose along with its key scans: as matched to the one before and to the one after,
/// in the ratio of their distance in time. before: world_from_robot of every pose as the key scans
/// were matched.
std::vector<Pose2> PosesFollowingKeyScans(const KeyGraph& key_graph,
                                          const std::vector<Pose2>& before);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_CLOSE_LOOPS_H_
