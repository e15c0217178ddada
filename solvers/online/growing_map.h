#ifndef PLUMBLINE_SOLVERS_ONLINE_GROWING_MAP_H_
#define PLUMBLINE_SOLVERS_ONLINE_GROWING_MAP_H_

#include <memory>
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
#include "plumbline/solvers/online/place_search.h"
#include "plumbline/solvers/online/saved_map.h"
#include "plumbline/solvers/seeding/seed_drive.h"

namespace plumbline {

/// How a drive goes with a saved map.
struct InSavedMap {
  std::shared_ptr<const SavedSession> map;
  bool is_fixed = false;    ///< the drive is localised: its pose may be lost, and is sought again
  bool keeps_scans = true;  ///< else old scans of a fixed map's drive are forgotten
};

/// A drive with the pose graph of its keyframes, which grow: closes loops from the newest
/// keyframes, by the loop closure of the seeding, and takes over a seeding of its first poses.
///
/// In a saved map the newest segment of the drive has a pose graph of its own until it is placed in
/// the map. Its keyframes then follow the keyframes of the map, which stay where they are. In a
/// fixed map the place is lost where a scan matches nothing, or where nothing of the map is
/// recognised over some path: a new segment begins there. Poses that are no longer estimated are
/// settled.
class GrowingMap {
 public:
  GrowingMap(const std::vector<LaserModel>& lasers, const MotionOptions& motion);

  /// Begins in a saved map, before the first scan.
  void StartIn(InSavedMap saved);

  /// Appends a scan. Its poses are chained to the map by the step that was matched.
  Status Add(const LiveScan& scan);

  /// Closes loops from the keyframes that are new since the last call. Unavailable if progress
  /// stopped it.
  Status CloseLoops(const SeedingProgress& progress, ThreadPool* pool);

  /// Takes over a seeding of the first poses, and chains the later ones to it. Its poses may have
  /// been refined: edges and closures are measured anew between them. motion: the noise of the
  /// odometry that it found.
  void Adopt(SeededDrive seeded, const MotionOptions& motion);

  /// The measurements of the drive so far, then the scans `later`, as MapLog takes them: odometry
  /// from each pose to the next one, or none if none was measured. It may be called while
  /// CloseLoops or Adopt run. InvalidArgument if old scans were forgotten.
  Status MakeLog(const std::vector<LiveScan>& later, SlamGraph* log) const;

  /// Places the segment where the robot was at its first pose, give or take 0.5 m and 0.15 rad.
  /// False if it has no keyframe yet.
  bool PlaceAt(const Pose2& map_from_robot);
  /// Copies the segment for a search of its place.
  Status MakeSearch(PlaceSearch* search) const;
  /// Places the segment where a search has found it. False if it was lost since.
  bool Place(const PlaceSearch& found);

  /// Whether the segment lies in the saved map.
  bool is_placed() const { return keys_.num_fixed > 0; }
  /// The first pose of the segment, and its path [m].
  int first_pose_of_segment() const { return static_cast<int>(settled_.size()); }
  double segment_path_m() const;

  int num_poses() const { return graph_.num_poses() - first_pose_ + num_forgotten_; }
  /// Of the segment.
  int num_keyframes() const { return keys_.size() - keys_.num_fixed; }
  int num_closures() const { return static_cast<int>(keys_.closures.size()); }
  /// Largest distance [m] by which loops have moved a keyframe since the last Adopt.
  double largest_correction_m() const { return largest_correction_m_; }
  /// Whether a scan before one of the keyframes since the last Adopt matched nothing.
  bool has_unmatched() const { return has_unmatched_; }
  /// world_from_robot of all poses of the drive, corrected by the loops.
  std::vector<Pose2> Poses() const;
  const SlamGraph& graph() const { return graph_; }

 private:
  void AddKeyframe(Keyframe keyframe);
  void Append(const Pose2& step, const Pose2& step_as_driven);
  int FirstIdOfSegment() const { return first_pose_ + first_pose_of_segment() - num_forgotten_; }
  std::vector<Pose2> PosesOfSegment() const;
  void PlaceBehindMap(const std::vector<Pose2>& map_from_key, const SequentialEdge& boundary);
  bool IsLost(int first_new_key) const;
  void BeginSegment();
  void SettleOldKeyframes();
  void ForgetBefore(int pose);

  const SlamGraph lasers_;  // alone
  MotionOptions motion_;
  InSavedMap saved_;
  SlamGraph graph_;                          // the saved map, then the drive
  int first_pose_ = 0;                       // of the drive in the graph
  int num_forgotten_ = 0;                    // poses of the drive before that
  std::vector<Pose2> settled_;               // world_from_robot before the segment
  Pose2 world_from_matched_;                 // of a segment without a place
  std::vector<std::optional<Pose2>> steps_;  // measured odometry, per pose
  MeasuredSurface surface_;
  std::vector<PackedSurface> kept_;  // per scan; empty but for keyframes
  SequentialTrajectory trajectory_;  // without its keyframes
  double path_m_ = 0.0;              // of the trajectory
  KeyframeGraph keys_;               // of the map if the segment is placed, then of the segment
  ClosureMemory memory_;
  int first_new_key_ = 0;
  double largest_correction_m_ = 0.0;
  bool has_unmatched_ = false;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_GROWING_MAP_H_
