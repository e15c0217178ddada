#include "plumbline/solvers/front_end/odometry_sign.h"

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"

namespace plumbline {
namespace {

// Smallest motion that counts as backward [m]: above the rounding of any log.
constexpr double kBackwardM = 0.002;
// Length of the steps that are asked [m]: shorter ones drown in range noise, longer ones in the
// ambiguity of the scene.
constexpr double kMinStepM = 0.03, kMaxStepM = 0.4;
// Largest sigma of a match relative to the motion: forward and backward then lie eight of them
// apart.
constexpr double kMaxRelativeSigma = 0.25;
// Evidence: at least this many contradicting steps, and this share of the decided ones.
constexpr int kMinContradicting = 5;
constexpr double kMinContradictingShare = 0.002;

// No sign is zero: processes add them up.
enum StepSign : int { kUndecided = 0, kAgrees, kContradicts };

// Share of a scan that has to fit.
constexpr double kMinFittingRatio = 0.7;

bool TellsForwardFromBackward(const ScanMatch& match, double length_m) {
  if (match.inlier_ratio < kMinFittingRatio) return false;
  Eigen::Matrix3d information = match.information;
  information.diagonal().array() += 1e-3;
  return std::sqrt(information.inverse()(0, 0)) <= kMaxRelativeSigma * length_m;
}

// Compares scan `to` with scan `from`. Matches it only where it fits no better at the odometry than
// at the reverse of it: with no prior on the translation, from standstill.
StepSign SignOfStep(const Pose2& odometry, int from_scan, int to_scan,
                    const ScanSurfaces& surfaces) {
  const double length = std::abs(odometry.x);
  if (length < kMinStepM || length > kMaxStepM) return kUndecided;
  const SurfacePoints from = surfaces.Of(from_scan), to = surfaces.Of(to_scan);
  LocalMap map(0.01);
  map.Rebuild({&from}, {Pose2()});
  const ScanMatchOptions options;
  const ScanMatch forward = MeasureFit(map, to, odometry, options);
  const Pose2 backward(-odometry.x, -odometry.y, odometry.yaw);
  if (forward.chi2 < MeasureFit(map, to, backward, options).chi2) {
    return TellsForwardFromBackward(forward, length) ? kAgrees : kUndecided;
  }
  PosePrediction prediction;
  prediction.world_from_robot = {0.0, 0.0, odometry.yaw};
  constexpr double kRotationSigmaRad = 0.1;
  prediction.information(2, 2) = 1.0 / (kRotationSigmaRad * kRotationSigmaRad);
  const ScanMatch match = MatchScan(map, to, prediction, options);
  // As long as the odometry says, one way or the other: anything else is a bad match.
  const double matched_m = match.world_from_robot.x;
  const bool same_length = std::abs(std::abs(matched_m) - length) < 0.5 * length;
  if (!same_length || !TellsForwardFromBackward(match, length)) return kUndecided;
  return matched_m * odometry.x > 0.0 ? kAgrees : kContradicts;
}

}  // namespace

OdometrySignReport CheckOdometrySign(const ScanSurfaces& surfaces, ThreadPool* pool) {
  OdometrySignReport report;
  const SlamGraph& graph = surfaces.graph();
  const std::vector<OdometryConstraint>& steps = graph.odometry();
  for (const OdometryConstraint& step : steps) {
    if (step.from_from_to.x < -kBackwardM) ++report.num_backward_steps;
  }
  if (report.num_backward_steps > 0) return report;

  // Each process matches the steps to its own scans.
  const std::vector<int>& scan_of_pose = surfaces.scan_of_pose();
  std::vector<std::size_t> own;
  std::vector<int> scans;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int from = scan_of_pose[steps[i].from], to = scan_of_pose[steps[i].to];
    if (from < 0 || to < 0 || !graph.HasScansOf(steps[i].to)) continue;
    own.push_back(i);
    scans.push_back(from);
  }
  const ScanSurfaces at_hand = surfaces.With(scans);
  std::vector<int> signs(steps.size(), kUndecided);
  constexpr std::size_t kStepsPerChunk = 32;
  pool->ForEach(own.size(), kStepsPerChunk, [&](std::size_t k) {
    const OdometryConstraint& step = steps[own[k]];
    signs[own[k]] = SignOfStep(step.from_from_to, scans[k], scan_of_pose[step.to], at_hand);
  });
  SumOverPeers(graph.peers(), &signs);
  // A robot that backs up does so for a while; a single contradicting step is a bad match.
  constexpr int kMinRun = 3;
  int run = 0;  // of contradicting steps, among the decided ones
  for (const int sign : signs) {
    if (sign == kUndecided) continue;
    ++report.num_decided;
    run = sign == kContradicts ? run + 1 : 0;
    if (run >= kMinRun) ++report.num_contradicting;
  }
  report.sign_lost = report.num_contradicting >= kMinContradicting &&
                     report.num_contradicting >= kMinContradictingShare * report.num_decided;
  return report;
}

}  // namespace plumbline
