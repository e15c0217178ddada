#include "plumbline/solvers/acceptance/constraint_start.h"

#include <algorithm>
#include <cmath>

#include "plumbline/core/map_state.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/pose_graph/chordal_start.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

// Every pose but the first has a step from the one before.
bool IsChain(const std::vector<RelativePoseConstraint>& steps, int num_poses) {
  std::vector<char> reached(num_poses);
  reached[0] = true;
  for (const RelativePoseConstraint& step : steps) reached[std::max(step.from, step.to)] = true;
  return std::find(reached.begin(), reached.end(), 0) == reached.end();
}

// Mean of the squared errors of steps [sigmas^2], three degrees of freedom each.
double MeanSquaredError(const std::vector<RelativePoseConstraint>& steps,
                        const std::vector<Pose2>& poses) {
  constexpr double kMostSigmas = 30.0;  // of one step
  double sum = 0.0;
  for (const RelativePoseConstraint& step : steps) {
    sum += std::min(EdgeChi2(step, poses), kMostSigmas * kMostSigmas);
  }
  return sum / (3.0 * static_cast<double>(steps.size()));
}

}  // namespace

std::optional<std::vector<double>> StartFromConstraints(
    const SlamGraph& graph, const std::vector<double>& state_poses, const MotionOptions& motion,
    const std::vector<ContradictedEdge>& contradicted) {
  std::vector<RelativePoseConstraint> steps, others;
  const auto add = [&](const RelativePoseConstraint& edge) {
    (std::abs(edge.from - edge.to) == 1 ? steps : others).push_back(edge);
  };
  for (const OdometryConstraint& c : graph.odometry()) {
    add({c.from, c.to, c.from_from_to, MotionCovariance(c.from_from_to, motion)});
  }
  std::vector<RelativePoseConstraint> edges = graph.relative_poses();
  for (const ContradictedEdge& c : contradicted) {
    edges[c.edge].covariance *= kIgnoredSigmaFactor * kIgnoredSigmaFactor;
    if (c.match) edges[c.edge] = *c.match;
  }
  for (const RelativePoseConstraint& c : edges) add(c);
  if (!IsChain(steps, graph.num_poses())) return std::nullopt;

  std::vector<Pose2> poses = PosesOf(state_poses);
  constexpr double kSigmas = 3.0;
  if (contradicted.empty() && !(MeanSquaredError(steps, poses) > kSigmas * kSigmas)) {
    return std::nullopt;
  }

  std::vector<int> fixed;
  for (const FixedPose& pose : graph.fixed_poses()) {
    poses[pose.pose] = pose.world_from_robot;
    fixed.push_back(pose.pose);
  }
  if (!ChordalStart(steps, fixed, &poses)) return std::nullopt;
  OptimizePoseGraph(steps, others, &poses, fixed);
  return PoseArray(poses);
}

}  // namespace plumbline
