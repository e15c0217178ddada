#ifndef PLUMBLINE_SOLVERS_ONLINE_GROWING_MAP_H_
#define PLUMBLINE_SOLVERS_ONLINE_GROWING_MAP_H_

#include <optional>
#include <vector>

#include "plumbline/core/laser_scan.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/sequential_seeding.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/loop_closure/closure_memory.h"
#include "plumbline/solvers/online/live_matching.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {

/// A drive with the pose graph of its keyframes, which grow: closes loops from the newest
/// keyframes, by the loop closure of the seeding, and takes over a seeding of its first poses.
class GrowingMap {
 public:
  GrowingMap(const std::vector<LaserModel>& lasers, const MotionOptions& motion);

  /// Appends a scan. Its poses are chained to the map by the step that was matched.
  Status Add(const LiveScan& scan);

  /// Closes loops from the keyframes that are new since the last call. Unavailable if progress
  /// stopped it.
  Status CloseLoops(const SeedingProgress& progress, ThreadPool* pool);

  /// Takes over a seeding of the first poses, and chains the later ones to it. Its poses may have
  /// been refined: edges and closures are measured anew between them. motion: the noise of the
  /// odometry that it found.
  void Adopt(SeededDrive seeded, const MotionOptions& motion);

  /// The measurements so far, then those of `later`, as MapLog takes them: odometry from each pose
  /// to the next one, or none if none was measured. It may be called while CloseLoops or Adopt run.
  Status MakeLog(const std::vector<LiveScan>& later, SlamGraph* log) const;

  int num_poses() const { return graph_.num_poses(); }
  int num_keyframes() const { return keys_.size(); }
  int num_closures() const { return static_cast<int>(keys_.closures.size()); }
  /// Largest distance [m] by which loops have moved a keyframe since the last Adopt.
  double largest_correction_m() const { return largest_correction_m_; }
  /// Whether a scan before one of the keyframes since the last Adopt matched nothing.
  bool has_unmatched() const { return has_unmatched_; }
  /// world_from_robot of all poses, corrected by the loops.
  std::vector<Pose2> Poses() const;
  const SlamGraph& graph() const { return graph_; }

 private:
  void AddKeyframe(Keyframe keyframe);
  void Append(const Pose2& step, const Pose2& step_as_driven);

  MotionOptions motion_;
  SlamGraph graph_;
  std::vector<std::optional<Pose2>> steps_;  // measured odometry, per pose
  MeasuredSurface surface_;
  std::vector<PackedSurface> kept_;  // per scan; empty but for keyframes
  SequentialTrajectory trajectory_;  // without its keyframes
  double path_m_ = 0.0;              // of the trajectory
  KeyframeGraph keys_;
  ClosureMemory memory_;
  int first_new_key_ = 0;
  double largest_correction_m_ = 0.0;
  bool has_unmatched_ = false;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_GROWING_MAP_H_
