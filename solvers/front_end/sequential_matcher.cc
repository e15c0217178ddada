#include "plumbline/solvers/front_end/sequential_matcher.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "plumbline/core/angle.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"

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
// A scan becomes a keyframe if it is turned by this much from those around: 20 degrees.
constexpr double kKeyframeAngleRad = 0.35;
// The local map is made of the nearest keyframes, at most this many, ...
constexpr int kMaxKeyframesInMap = 40;
// ... of the last stretch of this length [m] of the path: what is older may have drifted away.
constexpr double kMapPathM = 12.0;

Pose2 ReversedTranslation(const Pose2& motion) { return {-motion.x, -motion.y, motion.yaw}; }

// What a prediction says of a pose: the squared Mahalanobis distance, half its gradient, and the
// information, in axes of the world.
struct Pull {
  double chi2;
  Eigen::Vector3d gradient;
  Eigen::Matrix3d information;
};

Pull PullOf(const PosePrediction& prediction, const Pose2& world_from_robot) {
  const Pose2& predicted = prediction.world_from_robot;
  const Eigen::Matrix3d information = RotateAxes(prediction.information, predicted.yaw);
  const Eigen::Vector3d off(world_from_robot.x - predicted.x, world_from_robot.y - predicted.y,
                            NormalizeAngle(world_from_robot.yaw - predicted.yaw));
  const Eigen::Vector3d gradient = information * off;
  return {off.dot(gradient), gradient, information};
}

}  // namespace

ScanMatch SequentialMatcher::Match(const Pose2& previous, const SurfacePoints& scan, StepKind kind,
                                   Pose2* step, SequentialSeedingReport* report) {
  kind_ = kind;
  if (sign_lost_ && reversing_) *step = ReversedTranslation(*step);
  ScanMatch match = MatchStep(previous, *step, scan);
  const Pose2 other_step = ReversedTranslation(*step);
  if (sign_lost_ && step->x != 0.0 && MayExplainBetter(previous, *step, match, other_step)) {
    const ScanMatch other = MatchStep(previous, other_step, scan);
    if (other.chi2 < match.chi2 - kReversalChi2) {
      match = other;
      *step = other_step;
      reversing_ = !reversing_;
    }
  }
  if (reversing_ && step->x != 0.0) ++report->num_reversed_steps;
  if (kind_ == StepKind::kRough) SearchAll(Predict(previous, *step), scan, &match);
  const bool recovered =
      match.inlier_ratio < kSuspectInlierRatio && Recover(previous * *step, scan, &match);
  // A prediction measures nothing that a match could contradict.
  const bool is_slip =
      kind_ == StepKind::kMeasured && SigmasOff(previous, *step, match) > kSlipSigmas;
  if (match.inlier_ratio < (is_slip ? kMinSlipInlierRatio : kMinInlierRatio)) {
    ++report->num_unmatched;
    after_unmatched_ = after_unmatched_ || !scan.empty();
    match.world_from_robot = previous * *step;
    match.information.setZero();
  } else if (recovered) {
    ++report->num_recovered;
  }
  return match;
}

void SequentialMatcher::MaybeAddKeyframe(int pose, int scan, const SurfacePoints& surface,
                                         double path_m, const ScanMatch& match) {
  if (IsCovered(match.world_from_robot)) return;
  keyframes_.push_back({pose, scan, path_m,
                        RotateAxes(match.information, -match.world_from_robot.yaw),
                        std::exchange(after_unmatched_, false)});
  key_surfaces_.emplace_back(surface);
  key_poses_.push_back(match.world_from_robot);
  RebuildMap();
}

void SequentialMatcher::ForgetOldSurfaces() {
  for (; num_forgotten_ < keyframes_.size(); ++num_forgotten_) {
    if (keyframes_.back().path_m - keyframes_[num_forgotten_].path_m <= kMapPathM) return;
    key_surfaces_[num_forgotten_] = PackedSurface();
  }
}

PosePrediction SequentialMatcher::Predict(const Pose2& previous, const Pose2& step) const {
  // The motion's noise is given in the frame it starts from; the prediction wants its own.
  const MotionOptions& motion = kind_ == StepKind::kPredicted ? prediction_motion_ : motion_;
  return {previous * step, RotateAxes(MotionCovariance(step, motion).inverse(), -step.yaw)};
}

double SequentialMatcher::SigmasOff(const Pose2& previous, const Pose2& step,
                                    const ScanMatch& match) const {
  const PosePrediction predicted = Predict(previous, step);
  const Pose2 off = Between(predicted.world_from_robot, match.world_from_robot);
  const Eigen::Vector3d error(off.x, off.y, off.yaw);
  return std::sqrt(error.dot(predicted.information * error));
}

ScanMatch SequentialMatcher::MatchStep(const Pose2& previous, const Pose2& step,
                                       const SurfacePoints& scan) const {
  return MatchScan(map_, scan, Predict(previous, step), ScanMatchOptions());
}

// Whether another step could explain a scan better than the one that it was matched with: by the
// match's own Gauss-Newton model, in which the sum of squares of the points about the pose found is
// a parabola. Only what is clearly worse is ruled out. Spares most matches, as most scans tell
// which way the robot went.
bool SequentialMatcher::MayExplainBetter(const Pose2& previous, const Pose2& step,
                                         const ScanMatch& match, const Pose2& other_step) const {
  if (!match.converged || match.inlier_ratio < kSuspectInlierRatio) return true;
  const Pull pull = PullOf(Predict(previous, step), match.world_from_robot);
  const Pull other = PullOf(Predict(previous, other_step), match.world_from_robot);
  // At the pose found the points pull against its prediction, and as much.
  const Eigen::Vector3d gradient = other.gradient - pull.gradient;
  const Eigen::Matrix3d information = match.information + other.information;
  const double gain = pull.chi2 - other.chi2 + gradient.dot(information.ldlt().solve(gradient));
  constexpr double kMargin = 1.0;  // what the model may be off by; a reversal takes nine times that
  return !(gain <= -kMargin);
}

// Looks for a pose that scan and prediction together make more likely, anywhere around.
void SequentialMatcher::SearchAll(const PosePrediction& predicted, const SurfacePoints& scan,
                                  ScanMatch* match) const {
  const SearchWindow window{predicted.world_from_robot, kSearchM, kSearchRad};
  for (ScanMatch& other : MatchInWindow(map_, scan, window)) {
    other.chi2 += PullOf(predicted, other.world_from_robot).chi2;
    if (other.chi2 < match->chi2) *match = other;
  }
}

// Other matches, without weight on the prediction. Replaces the match if one of them fits clearly
// more of the scan.
bool SequentialMatcher::Recover(const Pose2& predicted, const SurfacePoints& scan,
                                ScanMatch* match) const {
  ScanMatch best = *match;
  for (const ScanMatch& other : MatchesFarOff(predicted, scan)) {
    if (other.inlier_ratio > best.inlier_ratio) best = other;
  }
  if (best.inlier_ratio < match->inlier_ratio + kRecoveryInlierGain) return false;
  *match = best;
  return true;
}

// All round the predicted heading, or anywhere around the prediction if that was not measured.
std::vector<ScanMatch> SequentialMatcher::MatchesFarOff(const Pose2& predicted,
                                                        const SurfacePoints& scan) const {
  if (kind_ != StepKind::kMeasured) {
    return MatchInWindow(map_, scan, {predicted, kSearchM, kSearchRad});
  }
  ScanMatchOptions wide;
  wide.coarse_gate_m *= 2.0;
  constexpr double kTurnRad = 0.12;  // the matcher finds back from half of this and more
  constexpr int kTurns = 4;          // to either side
  std::vector<ScanMatch> matches;
  matches.reserve(2 * kTurns + 1);
  for (int turn = -kTurns; turn <= kTurns; ++turn) {
    PosePrediction start;
    start.world_from_robot = predicted * Pose2(0.0, 0.0, turn * kTurnRad);
    matches.push_back(MatchScan(map_, scan, start, wide));
  }
  return matches;
}

bool SequentialMatcher::IsCovered(const Pose2& pose) const {
  return std::any_of(in_map_.begin(), in_map_.end(), [&](int k) {
    const Pose2 moved = Between(key_poses_[k], pose);
    return std::hypot(moved.x, moved.y) < options_.keyframe_distance_m &&
           std::abs(moved.yaw) < kKeyframeAngleRad;
  });
}

// Of the recent keyframes the nearest to the last one, which is among them.
void SequentialMatcher::RebuildMap() {
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
  std::vector<const PackedSurface*> scans;
  std::vector<Pose2> poses;
  in_map_.clear();
  for (const auto& [distance, age] : by_distance) {
    in_map_.push_back(last - age);
    scans.push_back(&key_surfaces_[last - age]);
    poses.push_back(key_poses_[last - age]);
  }
  map_.Rebuild(scans, poses);
}

void DriveTracker::Add(int pose, int scan, const SurfacePoints& surface, StepKind kind, Pose2 step,
                       SequentialSeedingReport* report) {
  ScanMatch match;
  match.world_from_robot = first_;
  if (poses_.empty()) {
    step = Pose2();
  } else {
    match = matcher_.Match(poses_.back(), surface, kind, &step, report);
    path_m_ += Between(poses_.back(), match.world_from_robot).translation().norm();
  }
  poses_.push_back(match.world_from_robot);
  steps_.push_back(step);
  if (scan >= 0) matcher_.MaybeAddKeyframe(pose, scan, surface, path_m_, match);
}

}  // namespace plumbline
