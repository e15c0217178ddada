#include "plumbline/solvers/front_end/sequential_seeding.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/front_end/correlative_matcher.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_sign.h"
#include "plumbline/solvers/front_end/odometry_span.h"
#include "plumbline/solvers/front_end/scan_matcher.h"

namespace plumbline {
namespace {

// A step is taken as reversed (or as forward again) only if that explains scan and odometry better
// by three standard deviations: where the scan cannot tell, the robot has not turned back.
constexpr double kReversalChi2 = 9.0;
// The shares of matched points were tuned on fr079 and intel, the one of slips as it says.

// Below this share of matched points the prediction is suspect, and other starts are tried.
constexpr double kSuspectInlierRatio = 0.6;
// Another start must match this much more of the scan to be believed against the odometry.
constexpr double kRecoveryInlierGain = 0.1;
// Below this share of matched points a match is not trusted and the odometry stands.
constexpr double kMinInlierRatio = 0.25;
// A match farther off the odometry than this many of its standard deviations says that the wheels
// have slipped. It is believed only if the scan fits all but completely: slips that were real do so
// on every indoor log at hand (0.83 and more). Among bushes and fences, where there is something
// near by in any place, half of a scan fits metres off and turned by a right angle.
constexpr double kSlipSigmas = 3.0;
constexpr double kMinSlipInlierRatio = 0.8;

// Without odometry a suspect scan is searched for this far around its prediction: some seconds of a
// walking pace, as between scans that were thinned out, and a turn to either side.
constexpr double kSearchM = 3.0;
constexpr double kSearchRad = 0.5 * kPi;
// Cells [m] of that search, as for loop closures: the matcher does the rest.
constexpr double kRecoveryCellM = 0.1;
constexpr int kMaxRecoveryPlaces = 5;

// The local map is made of the nearest keyframes, at most this many, ...
constexpr int kMaxKeyframesInMap = 40;
// ... of the last stretch of this length [m] of the path: what is older may have drifted away.
constexpr double kMapPathM = 12.0;

Pose2 ReversedTranslation(const Pose2& motion) { return {-motion.x, -motion.y, motion.yaw}; }

class SequentialMatcher {
 public:
  SequentialMatcher(const SequentialSeedingOptions& options, const MotionOptions& motion,
                    const std::vector<SurfacePoints>& surfaces, bool sign_lost, bool is_prediction)
      : options_(options),
        motion_(motion),
        surfaces_(surfaces),
        sign_lost_(sign_lost),
        is_prediction_(is_prediction) {}

  // Pose of the next scan, one odometry step after `previous`. Sets *step to the step as driven.
  ScanMatch Match(const Pose2& previous, const SurfacePoints& scan, Pose2* step,
                  SequentialSeedingReport* report) {
    if (sign_lost_ && reversing_) *step = ReversedTranslation(*step);
    ScanMatch match = MatchStep(previous, *step, scan);
    if (sign_lost_ && step->x != 0.0) {
      const Pose2 other_step = ReversedTranslation(*step);
      const ScanMatch other = MatchStep(previous, other_step, scan);
      if (other.chi2 < match.chi2 - kReversalChi2) {
        match = other;
        *step = other_step;
        reversing_ = !reversing_;
      }
    }
    if (reversing_ && step->x != 0.0) ++report->num_reversed_steps;
    const bool recovered =
        match.inlier_ratio < kSuspectInlierRatio && Recover(previous * *step, scan, &match);
    // A prediction measures nothing that a match could contradict.
    const bool is_slip = !is_prediction_ && SigmasOff(previous, *step, match) > kSlipSigmas;
    if (match.inlier_ratio < (is_slip ? kMinSlipInlierRatio : kMinInlierRatio)) {
      ++report->num_unmatched;
      match.world_from_robot = previous * *step;
      match.information.setZero();
    } else if (recovered) {
      ++report->num_recovered;
    }
    return match;
  }

  // Makes the scan a keyframe if the local map has none near its pose. `path_m`: driven so far.
  void MaybeAddKeyframe(int pose, int scan, double path_m, const ScanMatch& match) {
    if (IsCovered(match.world_from_robot)) return;
    keyframes_.push_back(
        {pose, scan, path_m, RotateAxes(match.information, -match.world_from_robot.yaw)});
    key_poses_.push_back(match.world_from_robot);
    RebuildMap();
  }

  std::vector<Keyframe> TakeKeyframes() { return std::move(keyframes_); }

 private:
  PosePrediction Predict(const Pose2& previous, const Pose2& step) const {
    // The motion's noise is given in the frame it starts from; the prediction wants its own.
    return {previous * step, RotateAxes(MotionCovariance(step, motion_).inverse(), -step.yaw)};
  }

  double SigmasOff(const Pose2& previous, const Pose2& step, const ScanMatch& match) const {
    const PosePrediction predicted = Predict(previous, step);
    const Pose2 off = Between(predicted.world_from_robot, match.world_from_robot);
    const Eigen::Vector3d error(off.x, off.y, off.yaw);
    return std::sqrt(error.dot(predicted.information * error));
  }

  ScanMatch MatchStep(const Pose2& previous, const Pose2& step, const SurfacePoints& scan) const {
    return MatchScan(map_, scan, Predict(previous, step), ScanMatchOptions());
  }

  // Other starts, without weight on the odometry. Replaces the match if one of them fits clearly
  // more of the scan.
  bool Recover(const Pose2& predicted, const SurfacePoints& scan, ScanMatch* match) const {
    ScanMatchOptions wide;
    if (!is_prediction_) wide.coarse_gate_m *= 2.0;
    ScanMatch best = *match;
    for (const Pose2& pose :
         is_prediction_ ? SearchStarts(predicted, scan) : TurnedStarts(predicted)) {
      PosePrediction start;
      start.world_from_robot = pose;
      const ScanMatch other = MatchScan(map_, scan, start, wide);
      if (other.inlier_ratio > best.inlier_ratio) best = other;
    }
    if (best.inlier_ratio < match->inlier_ratio + kRecoveryInlierGain) return false;
    *match = best;
    return true;
  }

  // All round the predicted heading.
  static std::vector<Pose2> TurnedStarts(const Pose2& predicted) {
    constexpr double kTurnRad = 0.12;  // the matcher finds back from half of this and more
    constexpr int kTurns = 4;          // to either side
    std::vector<Pose2> starts;
    for (int turn = -kTurns; turn <= kTurns; ++turn) {
      starts.push_back(predicted * Pose2(0.0, 0.0, turn * kTurnRad));
    }
    return starts;
  }

  // Where the scan fits anywhere around the prediction.
  std::vector<Pose2> SearchStarts(const Pose2& predicted, const SurfacePoints& scan) const {
    std::vector<Pose2> starts;
    if (scan.empty() || map_.points().empty()) return starts;
    constexpr double kMinScore = 0.3;
    constexpr PeakSize kPeak{0.5, 0.3};
    const CorrelativeMatcher search(map_.points(), kRecoveryCellM, kSearchM);
    for (const CorrelativeMatch& place : search.SearchPeaks(scan, {predicted, kSearchM, kSearchRad},
                                                            kMinScore, kMaxRecoveryPlaces, kPeak)) {
      starts.push_back(place.map_from_scan);
    }
    return starts;
  }

  bool IsCovered(const Pose2& pose) const {
    return std::any_of(in_map_.begin(), in_map_.end(), [&](int k) {
      const Pose2 moved = Between(key_poses_[k], pose);
      return std::hypot(moved.x, moved.y) < options_.keyframe_distance_m &&
             std::abs(moved.yaw) < options_.keyframe_angle_rad;
    });
  }

  // Of the recent keyframes the nearest to the last one, which is among them.
  void RebuildMap() {
    std::vector<std::pair<double, int>> by_distance;
    const int last = static_cast<int>(keyframes_.size()) - 1;
    for (int k = last; k >= 0; --k) {
      if (keyframes_[last].path_m - keyframes_[k].path_m > kMapPathM) break;
      const Pose2 moved = Between(key_poses_[last], key_poses_[k]);
      by_distance.emplace_back(std::hypot(moved.x, moved.y), last - k);
    }
    std::sort(by_distance.begin(), by_distance.end());
    if (static_cast<int>(by_distance.size()) > kMaxKeyframesInMap) {
      by_distance.resize(kMaxKeyframesInMap);
    }
    std::vector<const SurfacePoints*> scans;
    std::vector<Pose2> poses;
    in_map_.clear();
    for (const auto& [distance, age] : by_distance) {
      in_map_.push_back(last - age);
      scans.push_back(&surfaces_[keyframes_[last - age].scan]);
      poses.push_back(key_poses_[last - age]);
    }
    map_.Rebuild(scans, poses);
  }

  const SequentialSeedingOptions& options_;
  const MotionOptions& motion_;
  const std::vector<SurfacePoints>& surfaces_;
  const bool sign_lost_;
  const bool is_prediction_;  // steps are predicted, not measured
  bool reversing_ = false;
  std::vector<Keyframe> keyframes_;
  std::vector<Pose2> key_poses_;
  std::vector<int> in_map_;  // indices of the keyframes in the local map
  LocalMap map_;
};

}  // namespace

Status SeedSequentially(const SequentialSeedingOptions& options, const MotionOptions& motion,
                        const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                        const SeedingProgress& progress, ThreadPool* pool,
                        SequentialTrajectory* trajectory, SequentialSeedingReport* report) {
  const bool is_prediction = LacksOdometry(graph);
  const MotionPrediction prediction(graph);
  std::vector<int> step_to_pose;
  if (!is_prediction) PLUMBLINE_RETURN_IF_ERROR(FindOdometrySteps(graph, &step_to_pose));
  *report = SequentialSeedingReport();
  report->odometry_sign = CheckOdometrySign(graph, surfaces, pool);

  const int num_poses = graph.num_poses();
  const std::vector<int> scan_of_pose = MatchedScanOfPoses(graph, surfaces);
  SequentialMatcher matcher(options, motion, surfaces, report->odometry_sign.sign_lost,
                            is_prediction);
  std::vector<Pose2> poses(num_poses), odometry(num_poses);
  double path_m = 0.0;
  static const SurfacePoints kNoSurface;
  for (int pose = 0; pose < num_poses; ++pose) {
    const int scan = scan_of_pose[pose];
    ScanMatch match;
    match.world_from_robot = graph.InitialPose(0);
    if (pose > 0) {
      odometry[pose] = is_prediction ? prediction.Step(poses, pose)
                                     : graph.odometry()[step_to_pose[pose]].from_from_to;
      match = matcher.Match(poses[pose - 1], scan >= 0 ? surfaces[scan] : kNoSurface,
                            &odometry[pose], report);
      const Pose2 moved = Between(poses[pose - 1], match.world_from_robot);
      path_m += std::hypot(moved.x, moved.y);
    }
    poses[pose] = match.world_from_robot;
    if (scan >= 0) matcher.MaybeAddKeyframe(pose, scan, path_m, match);
    constexpr int kPosesPerReport = 100;
    if (pose % kPosesPerReport == 0 && progress &&
        !progress(SeedingPhase::kMatchingScans, pose, num_poses)) {
      return Status::Unavailable("seeding was stopped by its caller");
    }
  }
  *trajectory = {std::move(poses), std::move(odometry), matcher.TakeKeyframes()};
  report->num_keyframes = static_cast<int>(trajectory->keyframes.size());
  return Status::Ok();
}

}  // namespace plumbline
