#ifndef PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_MATCHER_H_
#define PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_MATCHER_H_

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
  const bool sign_lost_;
  StepKind kind_ = StepKind::kMeasured;  // of the step at hand
  bool reversing_ = false;
  bool after_unmatched_ = false;  // since the last keyframe
  std::vector<Keyframe> keyframes_;
  std::vector<PackedSurface> key_surfaces_;  // per keyframe
  std::vector<Pose2> key_poses_;             // likewise
  std::vector<int> in_map_;                  // indices of the keyframes in the local map
  LocalMap map_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FRONT_END_SEQUENTIAL_MATCHER_H_
