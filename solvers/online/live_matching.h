#ifndef PLUMBLINE_SOLVERS_ONLINE_LIVE_MATCHING_H_
#define PLUMBLINE_SOLVERS_ONLINE_LIVE_MATCHING_H_

#include <memory>
#include <optional>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/sequential_matcher.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// A scan on its way through an online mapper.
struct LiveScan {
  SlamGraph measured;                ///< one pose and one scan
  std::optional<Pose2> step;         ///< odometry from the scan before; none if it was not measured
  MeasuredSurface surface;           ///< of the scan
  Pose2 world_from_robot;            ///< as matched
  bool is_matched = true;            ///< else the pose follows from the step as driven
  Pose2 matched_step;                ///< from the scan before
  Pose2 step_as_driven;              ///< odometry with its sign corrected, or the predicted step
  std::optional<Keyframe> keyframe;  ///< the scan became one
  std::shared_ptr<const PackedSurface> key_surface;  ///< of the keyframe
};

/// What the seeding has found out about the odometry of a drive.
struct OdometryFaults {
  bool sign_lost = false;          ///< of the translation
  double translation_scale = 1.0;  ///< reported over true translation; 0: the odometry is of no use
};

/// Matches scans as they come in, by the matching of the seeding. The frame is that of the first
/// pose; it drifts as nothing closes loops here.
class LiveMatching {
 public:
  LiveMatching(const SeedingOptions& options, const MotionOptions& motion,
               const ReturnNormalOptions& normals);

  /// Matches the next scan: `measured` and `step` are given, the rest is filled in.
  void Match(LiveScan* scan);

  /// Counts from the next scan on.
  void SetOdometryFaults(const OdometryFaults& faults);

  /// As matched, one per scan.
  const std::vector<Pose2>& poses() const { return tracker_.poses(); }

 private:
  Pose2 PredictedStep() const;

  const SeedingOptions options_;
  const MotionOptions motion_;
  const ReturnNormalOptions normals_;
  ThreadPool pool_;
  OdometryFaults faults_;
  std::vector<double> timestamps_s_;
  SequentialSeedingReport report_;
  DriveTracker tracker_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ONLINE_LIVE_MATCHING_H_
