#include "plumbline/solvers/terms/pose_edges.h"

#include <cstddef>

#include "plumbline/factors/motion_factor.h"
#include "plumbline/factors/sqrt_information.h"

namespace plumbline {

PoseEdge MotionEdge(const OdometryConstraint& constraint, const MotionOptions& options) {
  return {constraint.from, constraint.to, MakeMotionResidual(constraint.from_from_to, options)};
}

PoseEdge RelativePoseEdge(const RelativePoseConstraint& constraint) {
  PoseEdge edge{constraint.from, constraint.to, {}};
  edge.residual.a_from_b = constraint.from_from_to;
  // The graph takes no covariance that this could fail on.
  SqrtInformation(constraint.covariance, &edge.residual.sqrt_information);
  return edge;
}

PoseEdges::PoseEdges(const SlamGraph& graph, const FactorOptions& options) {
  for (const OdometryConstraint& c : graph.odometry()) {
    motions.push_back(MotionEdge(c, options.motion));
  }
  for (const DownweightedStep& downweighted : options.downweighted_steps) {
    if (downweighted.step >= motions.size()) continue;
    motions[downweighted.step].residual.sqrt_information /= downweighted.sigma_factor;
  }
  for (const RelativePoseConstraint& c : graph.relative_poses()) {
    relative_poses.push_back(RelativePoseEdge(c));
  }
  for (const std::size_t ignored : options.ignored_relative_poses) {
    if (ignored >= relative_poses.size()) continue;
    relative_poses[ignored].residual.sqrt_information /= kIgnoredSigmaFactor;
  }
}

}  // namespace plumbline
