#include "plumbline/solvers/front_end/odometry_sign.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"

namespace plumbline {
namespace {

// A motion counts as backward from 2 mm on, which is above the rounding of any log.
constexpr double kBackwardM = 0.002;
// Steps shorter than this drown in range noise, longer ones in the ambiguity of the scene.
constexpr double kShortestStepM = 0.03;
constexpr double kLongestStepM = 0.4;
// The match must know the motion to a quarter of its length, so that forward and backward lie
// eight standard deviations apart.
constexpr double kMaxRelativeSigma = 0.25;
// Evidence: at least this many contradicting steps, and this share of the decided ones.
constexpr int kMinContradicting = 5;
constexpr double kMinContradictingShare = 0.002;

// No sign is zero: processes add them up.
enum StepSign : int { kUndecided = 0, kAgrees, kContradicts };

// Matches scan `to` against scan `from` with no prior on the translation, from standstill.
StepSign SignOfStep(const Pose2& odometry, int from_scan, int to_scan,
                    const ScanSurfaces& surfaces) {
  const double length = std::abs(odometry.x);
  if (length < kShortestStepM || length > kLongestStepM) return kUndecided;
  const SurfacePoints from = surfaces.Of(from_scan), to = surfaces.Of(to_scan);
  LocalMap map(0.01);
  map.Rebuild({&from}, {Pose2()});
  PosePrediction prediction;
  prediction.world_from_robot = {0.0, 0.0, odometry.yaw};
  constexpr double kRotationSigmaRad = 0.1;
  prediction.information(2, 2) = 1.0 / (kRotationSigmaRad * kRotationSigmaRad);
  const ScanMatch match = MatchScan(map, to, prediction, ScanMatchOptions());
  if (match.inlier_ratio < 0.7) return kUndecided;
  Eigen::Matrix3d information = match.information;
  information.diagonal().array() += 1e-3;
  const double sigma = std::sqrt(information.inverse()(0, 0));
  const double forward = match.world_from_robot.x;
  // As long as the odometry says, one way or the other: anything else is a bad match.
  const bool same_length = std::abs(std::abs(forward) - length) < 0.5 * length;
  if (sigma > kMaxRelativeSigma * length || !same_length) return kUndecided;
  return forward * odometry.x > 0.0 ? kAgrees : kContradicts;
}

// Processes that share the drive share the work.
std::vector<int> SignsOf(const OdometryConstraint* steps, std::size_t num_steps,
                         const ScanSurfaces& surfaces, ThreadPool* pool) {
  constexpr std::size_t kStepsPerChunk = 32;
  const Peers* peers = surfaces.graph().peers();
  const std::vector<int>& scan_of_pose = surfaces.scan_of_pose();
  std::vector<std::size_t> own;  // steps between two scans
  std::vector<int> scans;
  for (const std::size_t chunk :
       OwnShare(peers, ThreadPool::NumChunks(num_steps, kStepsPerChunk))) {
    const std::size_t begin = chunk * kStepsPerChunk;
    for (std::size_t i = begin; i < std::min(begin + kStepsPerChunk, num_steps); ++i) {
      const int from = scan_of_pose[steps[i].from], to = scan_of_pose[steps[i].to];
      if (from < 0 || to < 0) continue;
      own.push_back(i);
      scans.insert(scans.end(), {from, to});
    }
  }
  const ScanSurfaces at_hand = surfaces.With(scans);
  std::vector<int> signs(num_steps, kUndecided);
  pool->ForEachChunk(
      own.size(), kStepsPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          signs[own[k]] =
              SignOfStep(steps[own[k]].from_from_to, scans[2 * k], scans[2 * k + 1], at_hand);
        }
      });
  SumOverPeers(peers, &signs);
  return signs;
}

// num_left: steps that have not been asked. If the sign is lost, no answer of theirs changes that.
bool IsSignLost(const OdometrySignReport& report, std::size_t num_left) {
  const double num_steps = report.num_decided + static_cast<double>(num_left);
  return report.num_contradicting >= kMinContradicting &&
         report.num_contradicting >= kMinContradictingShare * num_steps;
}

}  // namespace

OdometrySignReport CheckOdometrySign(const ScanSurfaces& surfaces, ThreadPool* pool) {
  OdometrySignReport report;
  const std::vector<OdometryConstraint>& steps = surfaces.graph().odometry();
  for (const OdometryConstraint& step : steps) {
    if (step.from_from_to.x < -kBackwardM) ++report.num_backward_steps;
  }
  if (report.num_backward_steps > 0) return report;

  // Batch by batch: a drive that backs up early tells soon.
  constexpr std::size_t kStepsPerBatch = 512;
  constexpr int kShortestRun = 3;
  int run = 0;  // of contradicting steps, among the decided ones
  for (std::size_t first = 0; first < steps.size() && !report.sign_lost;) {
    const std::size_t size = std::min(kStepsPerBatch, steps.size() - first);
    for (const int sign : SignsOf(&steps[first], size, surfaces, pool)) {
      if (sign == kUndecided) continue;
      ++report.num_decided;
      run = sign == kContradicts ? run + 1 : 0;
      // A robot that backs up does so for a while; a single contradicting step is a bad match.
      if (run >= kShortestRun) ++report.num_contradicting;
    }
    first += size;
    report.sign_lost = IsSignLost(report, steps.size() - first);
  }
  return report;
}

}  // namespace plumbline
