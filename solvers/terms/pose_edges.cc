#include "plumbline/solvers/terms/pose_edges.h"

#include <cstddef>

#include "plumbline/factors/motion_factor.h"
#include "plumbline/factors/sqrt_information.h"

namespace plumbline {

PoseEdges::PoseEdges(const SlamGraph& graph, const FactorOptions& options) {
  for (const OdometryConstraint& c : graph.odometry()) {
    motions.push_back({c.from, c.to, MakeMotionResidual(c.from_from_to, options.motion)});
  }
  for (const DownweightedStep& downweighted : options.downweighted_steps) {
    if (downweighted.step >= motions.size()) continue;
    motions[downweighted.step].residual.sqrt_information /= downweighted.sigma_factor;
  }
  for (const RelativePoseConstraint& c : graph.relative_poses()) {
    PoseEdge edge{c.from, c.to, {}};
    edge.residual.a_from_b = c.from_from_to;
    // The graph takes no covariance that this could fail on.
    SqrtInformation(c.covariance, &edge.residual.sqrt_information);
    relative_poses.push_back(edge);
  }
  for (const std::size_t ignored : options.ignored_relative_poses) {
    if (ignored >= relative_poses.size()) continue;
    relative_poses[ignored].residual.sqrt_information /= kIgnoredSigmaFactor;
  }
}

}  // namespace plumbline
