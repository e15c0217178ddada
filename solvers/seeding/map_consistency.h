#ifndef PLUMBLINE_SOLVERS_SEEDING_MAP_CONSISTENCY_H_
#define PLUMBLINE_SOLVERS_SEEDING_MAP_CONSISTENCY_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/seeding/free_space.h"

namespace plumbline {

/// Two scans, of which one shows a surface where the other looked through.
struct SpaceConflict {
  int viewer_scan = 0;                                    ///< looked through
  int scan = 0;                                           ///< shows the surface
  Eigen::Vector2d world_point = Eigen::Vector2d::Zero();  ///< one of the returns in question [m]
};

/// Where on its path a robot's scans conflict most, and how much.
struct ConflictPeak {
  FreeSpaceConflict conflict;
  int pose = 0;  ///< in the middle of the stretch
  /// Half of the stretches of the same kind, where enough was compared, have no more than this
  /// times the conflicts that can be explained: how much people, doors, glass and bushes there are
  /// all over the place.
  double usual_ratio = 0.0;
};

/// What the scan of one place of the path has to do with others.
struct ViewpointConflict {
  int pose = 0;
  FreeSpaceConflict within_pass, between_passes;  ///< over the pairs that the scan is part of
};

/// How well the scans of a robot that saw the same places, in one pass or in several, agree on what
/// is free space.
struct MapConsistency {
  /// Sums over pairs of scans of one pass and of different passes, both ways.
  FreeSpaceConflict within_pass, between_passes;
  int num_pairs_within = 0;
  int num_pairs_between = 0;
  /// The place of the path whose two sides, up to 5 m each, conflict most with one another: where a
  /// jump of the poses would be.
  ConflictPeak worst_within;
  /// The stretch of 6 m of path that conflicts most with other passes.
  ConflictPeak worst_between;
  /// Share of such stretches with more than 3 times the conflicts that can be explained.
  double contradicted_share = 0.0;
  /// Per scan that was compared, in order of the path.
  std::vector<ViewpointConflict> viewpoints;
  /// One per pair and direction with many conflicting returns, in order of the scans.
  std::vector<SpaceConflict> places;

  /// Share of conflicting returns that people, doors, glass and noise explain: the share within one
  /// pass, but no less than doors that open and close bring about between two passes, and no more
  /// than a crowd does.
  double ExplicableShare() const;

  /// Conflicts of a peak over the ones that can be explained: by the explicable share, and by what
  /// is usual on this drive where that is more than a sixth of it. (Simulated drives have a
  /// fiftieth of it, and peaks below 1; real ones that are right have a tenth to a half, and peaks
  /// of 1.3 to 4 before what is usual is taken off: the share of a peak grows with the share of the
  /// rest.) What is usual excuses three times as much at most. Drawn towards 1 where little was
  /// compared, and 1 where nothing was.
  double Ratio(const ConflictPeak& peak) const;

  /// Whether a part of the map must be wrong there: the ratio is above 3.
  bool IsContradictory(const ConflictPeak& peak) const;

  /// The peak of the higher ratio, and what is said of it.
  const ConflictPeak& WorstPeak() const;
  double Ratio() const { return Ratio(WorstPeak()); }
  /// Sound maps stay below this ratio.
  static constexpr double kSuspiciousRatio = 2.0;
  /// That, or a quarter of all stretches contradict other passes, or half of them do a little.
  bool IsContradictory() const;

  /// Share of conflicting returns of different passes over the one within a pass; not finite where
  /// one pass has no conflict.
  double BetweenOverWithin() const { return between_passes.Share() / within_pass.Share(); }
};

/// Compares scans every half metre of the path with a bounded number of others: of the same pass
/// (1 m to 5 m of path away), and of other passes (more than 8 m of path, less than about 4 m in
/// space away). The work is linear in the length of the path; the result does not depend on the
/// number of threads. Expects poses in order of time.
///
/// Chooses the scans once, by one estimate of the poses, and then measures any number of others of
/// the same drive. Const, so that several threads can measure at a time.
class ConsistencyMeter {
 public:
  /// world_from_robot: one finite pose per pose of the graph, which must outlive the meter.
  ConsistencyMeter(const SlamGraph& graph, const std::vector<Pose2>& world_from_robot);

  MapConsistency Measure(const std::vector<Pose2>& world_from_robot, ThreadPool* pool) const;

 private:
  const SlamGraph& graph_;
  std::vector<int> scans_;
  std::vector<FreeSpaceScan> free_space_;  // of these scans
};

/// The same for one estimate of the poses.
MapConsistency MeasureMapConsistency(const SlamGraph& graph,
                                     const std::vector<Pose2>& world_from_robot, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SEEDING_MAP_CONSISTENCY_H_
