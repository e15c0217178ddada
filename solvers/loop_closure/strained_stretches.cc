#include "plumbline/solvers/loop_closure/strained_stretches.h"

#include <algorithm>
#include <cstddef>

#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {

double StepsChi2(const KeyframeGraph& keys, int first, int end) {
  double chi2 = 0.0;
  for (int k = first; k < end; ++k) {
    const SequentialEdge& edge = keys.sequential[k];
    if (!edge.broken) chi2 += EdgeChi2(edge.constraint, keys.world_from_key);
  }
  return chi2;
}

double GraphChi2(const KeyframeGraph& keys) {
  double chi2 = StepsChi2(keys, 0, keys.size() - 1);
  for (const RelativePoseConstraint& closure : keys.closures) {
    chi2 += EdgeChi2(closure, keys.world_from_key);
  }
  return chi2;
}

double MostStrain(double chi2_of_others, std::size_t num_closures) {
  // What sound drives are off by: few closures may fit better by chance.
  constexpr double kLeastShare = 0.01;
  const double degrees_of_freedom = 3.0 * static_cast<double>(num_closures);
  const double share_of_allowed = chi2_of_others / std::max(1.0, degrees_of_freedom);
  return LoopAcceptance::kMaxEdgeChi2 * std::clamp(share_of_allowed, kLeastShare, 1.0);
}

std::vector<std::pair<int, int>> StretchesBetweenClosures(const KeyframeGraph& keys) {
  std::vector<char> is_end(keys.size(), 0);
  for (const RelativePoseConstraint& closure : keys.closures) {
    is_end[closure.from] = is_end[closure.to] = 1;
  }
  for (int k = 0; k + 1 < keys.size(); ++k) {
    if (keys.sequential[k].between_sessions) is_end[k] = is_end[k + 1] = 1;
  }
  std::vector<std::pair<int, int>> stretches;
  int first = 0;
  for (int k = 1; k < keys.size(); ++k) {
    if (is_end[k] == 0) continue;
    stretches.emplace_back(first, k);
    first = k;
  }
  return stretches;
}

std::vector<int> MostStrainedSteps(const ScanSurfaces& surfaces,
                                   const std::vector<Pose2>& world_from_robot,
                                   const KeyframeGraph& keys, KeyframeGraph* marked) {
  const double chi2_of_graph = GraphChi2(keys);
  std::vector<int> steps;
  for (const auto& [first, end] : StretchesBetweenClosures(keys)) {
    const double chi2 = StepsChi2(keys, first, end);
    const double most_chi2 = MostStrain(chi2_of_graph - chi2, keys.closures.size());
    if (chi2 <= most_chi2) continue;
    const int step = MarkWorstEdge(surfaces, world_from_robot, first, end, marked);
    const double others_chi2 = chi2 - StepsChi2(keys, step, step + 1);
    if (marked->sequential[step].evidence > 0.0 && others_chi2 > most_chi2) steps.push_back(step);
  }
  return steps;
}

}  // namespace plumbline
