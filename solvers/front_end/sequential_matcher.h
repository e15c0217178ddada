#ifndef PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_MATCHER_H_
#define PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_MATCHER_H_

#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/core/pose2.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/front_end/keyframe_graph.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/front_end/surface_points.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/seeding_report.h"

namespace plumbline {

/// How a step is known before it is matched.
enum class StepKind {
  kMeasured,   ///< by odometry
  kPredicted,  ///< from the steps before
  kRough,      ///< measured, but worse than the matcher can follow without a search
};

/// Matches the scans of a drive one after the other, each against a local map of the keyframes
/// before it. What it is made of has to outlive it.
class SequentialMatcher {
 public:
  /// motion: the noise of steps that are not predicted. sign_lost: of the odometry's translation.
  SequentialMatcher(const SeedingOptions& options, const MotionOptions& motion, bool sign_lost)
      : options_(options),
        motion_(motion),
        prediction_motion_(PredictionPrior(motion)),
        sign_lost_(sign_lost) {}

  /// Pose of the next scan, one step after `previous`. Sets *step to the step as driven
  /// and counts in *report what it did.
  ScanMatch Match(const Pose2& previous, const SurfacePoints& scan, StepKind kind, Pose2* step,
                  SequentialSeedingReport* report);

  /// Makes the scan a keyframe if the local map has none near its pose. path_m: driven so far.
  void MaybeAddKeyframe(int pose, int scan, const SurfacePoints& surface, double path_m,
                        const ScanMatch& match);

  /// Frees the surfaces of keyframes too far back on the path for the local map.
  void ForgetOldSurfaces();

  /// Whether the odometry has lost the sign of its translation, from the next scan on.
  void set_sign_lost(bool sign_lost) { sign_lost_ = sign_lost; }

  /// In order of time.
  const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  std::vector<Keyframe> TakeKeyframes() { return std::move(keyframes_); }
  std::vector<PackedSurface> TakeKeySurfaces() { return std::move(key_surfaces_); }

 private:
  PosePrediction Predict(const Pose2& previous, const Pose2& step) const;
  double SigmasOff(const Pose2& previous, const Pose2& step, const ScanMatch& match) const;
  ScanMatch MatchStep(const Pose2& previous, const Pose2& step, const SurfacePoints& scan) const;
  bool MayExplainBetter(const Pose2& previous, const Pose2& step, const ScanMatch& match,
                        const Pose2& other_step) const;
  void SearchAll(const PosePrediction& predicted, const SurfacePoints& scan,
                 ScanMatch* match) const;
  bool Recover(const Pose2& predicted, const SurfacePoints& scan, ScanMatch* match) const;
  std::vector<ScanMatch> MatchesFarOff(const Pose2& predicted, const SurfacePoints& scan) const;
  bool IsCovered(const Pose2& pose) const;
  void RebuildMap();

  const SeedingOptions& options_;
  const MotionOptions& motion_;
  const MotionOptions prediction_motion_;
  bool sign_lost_;
  StepKind kind_ = StepKind::kMeasured;  // of the step at hand
  bool reversing_ = false;
  bool after_unmatched_ = false;  // since the last keyframe
  std::vector<Keyframe> keyframes_;
  std::vector<PackedSurface> key_surfaces_;  // per keyframe; empty if forgotten
  std::size_t num_forgotten_ = 0;
  std::vector<Pose2> key_poses_;  // likewise
  std::vector<int> in_map_;       // indices of the keyframes in the local map
  LocalMap map_;
};

/// Matches a drive, or a stretch of one, scan by scan, and keeps the pose of every scan. The
/// options and the noise have to outlive it.
class DriveTracker {
 public:
  /// first: world_from_robot of the first pose. The others as for SequentialMatcher.
  DriveTracker(const SeedingOptions& options, const MotionOptions& motion, bool sign_lost,
               const Pose2& first)
      : matcher_(options, motion, sign_lost), first_(first) {}

  /// Matches the scan of the next pose. pose, scan: their ids; scan is -1 if the pose has none that
  /// shows a surface. step: from the pose before, as it is known before the match; the first pose
  /// has none. Adds to the counts of *report.
  void Add(int pose, int scan, const SurfacePoints& surface, StepKind kind, Pose2 step,
           SequentialSeedingReport* report);

  /// world_from_robot, one per pose.
  const std::vector<Pose2>& poses() const { return poses_; }
  /// Steps as driven, one per pose, from the pose before; the first one is unused.
  const std::vector<Pose2>& steps() const { return steps_; }
  SequentialMatcher& matcher() { return matcher_; }
  std::vector<Pose2> TakePoses() { return std::move(poses_); }
  std::vector<Pose2> TakeSteps() { return std::move(steps_); }

 private:
  SequentialMatcher matcher_;
  const Pose2 first_;
  std::vector<Pose2> poses_;
  std::vector<Pose2> steps_;
  double path_m_ = 0.0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_MATCHER_H_
