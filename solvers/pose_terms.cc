#include "plumbline/solvers/pose_terms.h"

#include "plumbline/factors/motion_factor.h"
#include "plumbline/factors/sqrt_information.h"

namespace plumbline {

PoseTerms::PoseTerms(const SlamGraph& graph, const FactorOptions& options)
    : is_constant(graph.num_poses(), false) {
  for (const FixedPose& fixed : graph.fixed_poses()) is_constant[fixed.pose] = true;
  for (const OdometryConstraint& c : graph.odometry()) {
    motions.push_back({c.from, c.to, MakeMotionResidual(c.from_from_to, options.motion)});
  }
  for (const DoubtedStep& doubted : options.doubted_steps) {
    if (doubted.step >= motions.size()) continue;
    motions[doubted.step].residual.sqrt_information /= doubted.sigma_factor;
  }
  for (const RelativePoseConstraint& c : graph.relative_poses()) {
    PoseEdge edge{c.from, c.to, {}};
    edge.residual.a_from_b = c.from_from_to;
    // The graph takes no covariance that this could fail on.
    SqrtInformation(c.covariance, &edge.residual.sqrt_information);
    relative_poses.push_back(edge);
  }
}

double PoseTerms::Cost(const std::vector<double>& poses) const {
  double sum = 0.0;
  Eigen::Vector3d r;
  for (const std::vector<PoseEdge>* edges : {&motions, &relative_poses}) {
    for (const PoseEdge& edge : *edges) {
      edge.residual.Evaluate(&poses[3 * edge.from], &poses[3 * edge.to], r.data(), nullptr,
                             nullptr);
      sum += r.squaredNorm();
    }
  }
  return 0.5 * sum;
}

}  // namespace plumbline
