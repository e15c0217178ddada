#include "plumbline/apps/benchmark/match_graph.h"

#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

std::vector<RelativePoseConstraint> MatchConsecutive(const SlamGraph& graph,
                                                     const std::vector<SurfacePoints>& surfaces,
                                                     const MotionOptions& motion,
                                                     const MatchGraphOptions& options) {
  std::vector<RelativePoseConstraint> edges;
  for (const OdometryConstraint& step : graph.odometry()) {
    const PairMatch match =
        MatchPair(surfaces[step.from], surfaces[step.to], step.from_from_to, options.icp);
    if (match.inlier_ratio >= kMinPairInlierRatio) {
      edges.push_back({step.from, step.to, match.from_from_to, match.covariance});
    } else {
      edges.push_back(
          {step.from, step.to, step.from_from_to, MotionCovariance(step.from_from_to, motion)});
    }
  }
  return edges;
}

std::vector<RelativePoseConstraint> MatchNearby(const std::vector<SurfacePoints>& surfaces,
                                                const std::vector<Pose2>& poses,
                                                const MatchGraphOptions& options) {
  std::vector<RelativePoseConstraint> closures;
  const int num_poses = static_cast<int>(poses.size());
  for (int from = 0; from < num_poses; ++from) {
    for (int to = from + 2; to < num_poses; ++to) {
      const Pose2 guess = Between(poses[from], poses[to]);
      if (guess.translation().norm() > options.radius_m) continue;
      const PairMatch match = MatchPair(surfaces[from], surfaces[to], guess, options.icp);
      if (!match.converged || match.inlier_ratio < options.min_inlier_ratio) continue;
      closures.push_back({from, to, match.from_from_to, match.covariance});
    }
  }
  return closures;
}

}  // namespace

MatchGraph BuildMatchGraph(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                           const MotionOptions& motion, const MatchGraphOptions& options) {
  MatchGraph result;
  result.edges = MatchConsecutive(graph, surfaces, motion, options);
  result.chain.push_back(graph.InitialPose(0));
  for (const RelativePoseConstraint& edge : result.edges) {
    result.chain.push_back(result.chain[edge.from] * edge.from_from_to);
  }
  std::vector<Pose2> poses = result.chain;
  std::vector<RelativePoseConstraint> closures;
  for (int round = 0; round < options.rounds; ++round) {
    closures = MatchNearby(surfaces, poses, options);
    OptimizePoseGraph(result.edges, closures, &poses);
  }
  for (const RelativePoseConstraint& closure : closures) {
    if (EdgeChi2(closure, poses) <= options.max_chi2) result.edges.push_back(closure);
  }
  return result;
}

}  // namespace plumbline
