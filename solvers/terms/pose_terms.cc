#include "plumbline/solvers/terms/pose_terms.h"

#include <memory>

#include "plumbline/solvers/terms/terms.h"

namespace plumbline {

PoseTerms::PoseTerms(const SlamGraph& graph, const FactorOptions& options)
    : is_constant(graph.num_poses(), false),
      shared_graph(graph.peers() != nullptr ? &graph : nullptr) {
  for (const FixedPose& fixed : graph.fixed_poses()) is_constant[fixed.pose] = true;
  const Associations none;
  for (const std::shared_ptr<const Term>& term : MakeTerms(graph, none, options)) {
    if (!term->SeesPoints()) terms.push_back(term);
  }
}

double PoseTerms::Cost(const std::vector<double>& poses) const {
  double sum = 0.0;
  for (const auto& term : terms) term->AddSquares(poses.data(), &sum);
  return 0.5 * sum;
}

}  // namespace plumbline
