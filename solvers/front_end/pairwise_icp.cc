#include "plumbline/solvers/front_end/pairwise_icp.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/float_environment.h"
#include "plumbline/core/options_check.h"
#include "plumbline/solvers/front_end/align_points.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/odometry_span.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"

namespace plumbline {
namespace {

// Cells this small [m] leave a thinned scan as it is, but for points that lie on one another.
constexpr double kCellM = 0.01;
// A gate's correspondences have settled when a step moves the points by less than this share of it.
constexpr double kConvergedGateShare = 0.02;
// Fewer correspondences determine no turn.
constexpr Eigen::Index kMinMatches = 3;

constexpr int kMaxIterations = 100;
// Iterations end when a step at the fine gate moves the points by less than this [m].
constexpr double kStepToleranceM = 1e-4;

ScanMatchOptions MatcherOptions(const PairwiseIcpOptions& options) {
  ScanMatchOptions matcher;
  matcher.coarse_gate_m = options.gate_m;
  matcher.fine_gate_m = options.fine_gate_m;
  matcher.max_iterations = kMaxIterations;
  matcher.sigma_m = options.sigma_m;
  matcher.step_tolerance_m = kStepToleranceM;
  return matcher;
}

// Upper bound of how far a point moves when the pose of its scan changes [m].
double LargestMotion(const Pose2& before, const Pose2& after, double reach_m) {
  const Pose2 moved = Between(before, after);
  return moved.translation().norm() + reach_m * std::abs(moved.yaw);
}

// Iterative closest point of Besl & McKay. Returns whether it converged; *pose: map_from_scan.
bool MatchPoints(const LocalMap& map, const SurfacePoints& scan, const PairwiseIcpOptions& options,
                 Pose2* pose) {
  double reach_m = 0.0;
  for (const SurfacePoint& point : scan) reach_m = std::max(reach_m, point.position.norm());
  std::vector<const SurfacePoint*> matches(scan.size(), nullptr);
  Eigen::Matrix2Xd in_map(2, scan.size()), in_scan(2, scan.size());  // the matched points
  double gate_m = options.gate_m;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Eigen::Index count = 0;
    const FrameChange map_from_scan(*pose);
    for (std::size_t i = 0; i < scan.size(); ++i) {
      matches[i] = map.Nearest(map_from_scan * scan[i], gate_m, matches[i]);
      if (matches[i] == nullptr) continue;
      in_map.col(count) = matches[i]->position;
      in_scan.col(count++) = scan[i].position;
    }
    if (count < kMinMatches) return false;
    const Pose2 before = *pose;
    *pose = AlignPoints(in_map.leftCols(count), in_scan.leftCols(count));
    const double moved_m = LargestMotion(before, *pose, reach_m);
    if (gate_m <= options.fine_gate_m && moved_m < kStepToleranceM) return true;
    if (moved_m < kConvergedGateShare * gate_m) {
      gate_m = std::max(options.fine_gate_m, 0.5 * gate_m);
    }
  }
  return false;
}

// A pose with the pose that it is matched to.
struct ScanPair {
  int from = -1;  // -1: no surface is seen from the pose, or from any before it
  Pose2 guess;
  PairMatch match;
};

// Pairs every pose that shows a surface with the last such one before it.
std::vector<ScanPair> FindPairs(const SlamGraph& graph, const std::vector<int>& step_to_pose,
                                const std::vector<int>& scan_of_pose) {
  std::vector<ScanPair> pairs(graph.num_poses());
  int last = -1;
  Pose2 since_last;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    if (pose > 0) since_last = since_last * graph.odometry()[step_to_pose[pose]].from_from_to;
    if (scan_of_pose[pose] < 0) continue;
    pairs[pose].from = last;
    pairs[pose].guess = since_last;
    last = pose;
    since_last = Pose2();
  }
  return pairs;
}

}  // namespace

PairwiseIcpOptions IcpOptionsFor(const RangeBeamOptions& beam, IcpMetric metric) {
  PairwiseIcpOptions icp;
  icp.metric = metric;
  icp.sigma_m = std::sqrt(2.0) * beam.sigma_range_m;
  icp.fine_gate_m = std::max(icp.fine_gate_m, 3.0 * icp.sigma_m);
  icp.gate_m = std::max(icp.gate_m, icp.fine_gate_m);
  return icp;
}

bool PairwiseIcpOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(fine_gate_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(gate_m, >=, fine_gate_m);
  PLUMBLINE_CHECK_FINITE_OPTION(sigma_m, >, 0.0);
  return true;
}

PairMatch MatchPair(const SurfacePoints& from, const SurfacePoints& to, const Pose2& guess,
                    const PairwiseIcpOptions& options) {
  const DefaultFloatEnvironment float_environment;
  LocalMap map(kCellM);
  map.Rebuild({&from}, {Pose2()});
  PosePrediction start;
  start.world_from_robot = guess;
  const ScanMatchOptions matcher = MatcherOptions(options);
  ScanMatch match;
  if (options.metric == IcpMetric::kPointToLine) {
    match = MatchScan(map, to, start, matcher);
  } else {
    const bool converged = MatchPoints(map, to, options, &start.world_from_robot);
    match = MeasureFit(map, to, start.world_from_robot, matcher);
    match.converged = converged;
  }
  return {match.world_from_robot, MatchCovariance(match.information), match.inlier_ratio,
          match.converged};
}

Status ChainPairs(const PairwiseIcpOptions& options, const MeasuredSurface& surface,
                  ThreadPool* pool, const SlamGraph& graph, MapState* state) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  if (surface.normals.size() != graph.num_returns()) {
    return Status::InvalidArgument("pairwise ICP needs one normal per return, " +
                                   std::to_string(graph.num_returns()) + ", but got " +
                                   std::to_string(surface.normals.size()));
  }
  std::vector<int> step_to_pose;
  PLUMBLINE_RETURN_IF_ERROR(FindOdometrySteps(graph, &step_to_pose));
  const ScanSurfaces surfaces(graph, surface);
  const std::vector<int>& scan_of_pose = surfaces.scan_of_pose();
  std::vector<ScanPair> pairs = FindPairs(graph, step_to_pose, scan_of_pose);
  constexpr std::size_t kPairsPerChunk = 32;
  pool->ForEach(pairs.size(), kPairsPerChunk, [&](std::size_t to) {
    ScanPair& pair = pairs[to];
    if (pair.from < 0) return;
    pair.match = MatchPair(surfaces.Of(scan_of_pose[pair.from]), surfaces.Of(scan_of_pose[to]),
                           pair.guess, options);
  });
  std::vector<Pose2> poses = PosesOf(graph.initial_poses());
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    const ScanPair& pair = pairs[pose];
    const bool matched = pair.from >= 0 && pair.match.inlier_ratio >= kMinPairInlierRatio;
    poses[pose] = matched ? poses[pair.from] * pair.match.from_from_to
                          : poses[pose - 1] * graph.odometry()[step_to_pose[pose]].from_from_to;
  }
  state->poses = PoseArray(poses);
  state->points = graph.MeasuredMap(state->poses);
  return Status::Ok();
}

}  // namespace plumbline
