#include "plumbline/solvers/front_end/odometry_sign.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

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

enum class StepSign { kUndecided, kAgrees, kContradicts };

// Matches scan `to` against scan `from` with no prior on the translation, from standstill.
StepSign SignOfStep(const Pose2& odometry, int from_scan, int to_scan,
                    const ScanSurfaces& surfaces) {
  const double length = std::abs(odometry.x);
  if (length < kShortestStepM || length > kLongestStepM) return StepSign::kUndecided;
  const SurfacePoints from = surfaces.Of(from_scan), to = surfaces.Of(to_scan);
  LocalMap map(0.01);
  map.Rebuild({&from}, {Pose2()});
  PosePrediction prediction;
  prediction.world_from_robot = {0.0, 0.0, odometry.yaw};
  constexpr double kRotationSigmaRad = 0.1;
  prediction.information(2, 2) = 1.0 / (kRotationSigmaRad * kRotationSigmaRad);
  const ScanMatch match = MatchScan(map, to, prediction, ScanMatchOptions());
  if (match.inlier_ratio < 0.7) return StepSign::kUndecided;
  Eigen::Matrix3d information = match.information;
  information.diagonal().array() += 1e-3;
  const double sigma = std::sqrt(information.inverse()(0, 0));
  const double forward = match.world_from_robot.x;
  // As long as the odometry says, one way or the other: anything else is a bad match.
  const bool same_length = std::abs(std::abs(forward) - length) < 0.5 * length;
  if (sigma > kMaxRelativeSigma * length || !same_length) return StepSign::kUndecided;
  return forward * odometry.x > 0.0 ? StepSign::kAgrees : StepSign::kContradicts;
}

// num_left: steps that have not been asked. If the sign is lost, no answer of theirs changes that.
bool IsSignLost(const OdometrySignReport& report, std::size_t num_left) {
  const double num_steps = report.num_decided + static_cast<double>(num_left);
  return report.num_contradicting >= kMinContradicting &&
         report.num_contradicting >= kMinContradictingShare * num_steps;
}

}  // namespace

OdometrySignReport CheckOdometrySign(const SlamGraph& graph, const ScanSurfaces& surfaces,
                                     ThreadPool* pool) {
  OdometrySignReport report;
  for (const OdometryConstraint& step : graph.odometry()) {
    if (step.from_from_to.x < -kBackwardM) ++report.num_backward_steps;
  }
  if (report.num_backward_steps > 0) return report;

  const std::vector<int> scan_of_pose = MatchedScanOfPoses(graph, surfaces);
  const std::vector<OdometryConstraint>& steps = graph.odometry();
  std::vector<StepSign> signs(steps.size(), StepSign::kUndecided);
  const auto decide = [&](std::size_t i) {
    const int from = scan_of_pose[steps[i].from], to = scan_of_pose[steps[i].to];
    if (from < 0 || to < 0) return;
    signs[i] = SignOfStep(steps[i].from_from_to, from, to, surfaces);
  };
  // Batch by batch: a drive that backs up early tells soon.
  constexpr std::size_t kStepsPerBatch = 512, kStepsPerChunk = 32;
  constexpr int kShortestRun = 3;
  int run = 0;  // of contradicting steps, among the decided ones
  for (std::size_t first = 0; first < steps.size() && !report.sign_lost;) {
    const std::size_t size = std::min(kStepsPerBatch, steps.size() - first);
    pool->ForEachChunk(size, kStepsPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) decide(first + i);
    });
    first += size;
    for (std::size_t i = first - size; i < first; ++i) {
      if (signs[i] == StepSign::kUndecided) continue;
      ++report.num_decided;
      run = signs[i] == StepSign::kContradicts ? run + 1 : 0;
      // A robot that backs up does so for a while; a single contradicting step is a bad match.
      if (run >= kShortestRun) ++report.num_contradicting;
    }
    report.sign_lost = IsSignLost(report, steps.size() - first);
  }
  return report;
}

}  // namespace plumbline
