#include "plumbline/solvers/hypotheses/strained_stretches.h"

#include <algorithm>
#include <cstddef>

#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

// A closure that is known to this [m] holds both coordinates. One along a corridor gives way like
// the steps do.
constexpr double kFirmSigmaM = 0.1;

}  // namespace

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

double MostStrain(double chi2_of_others, std::size_t num_closures, int num_closures_inside) {
  // What sound drives are off by: few closures may fit better by chance.
  constexpr double kLeastShare = 0.01;
  constexpr double kDegreesOfFreedom = 3.0;  // of a closure
  const double share_of_allowed =
      chi2_of_others / std::max(1.0, kDegreesOfFreedom * static_cast<double>(num_closures));
  return (LoopAcceptance::kMaxEdgeChi2 + kDegreesOfFreedom * num_closures_inside) *
         std::clamp(share_of_allowed, kLeastShare, 1.0);
}

std::vector<StretchOfSteps> StretchesBetweenClosures(const KeyframeGraph& keys) {
  if (keys.size() == 0) return {};
  std::vector<char> is_end(keys.size(), 0);
  int last = 0;
  for (const RelativePoseConstraint& closure : keys.closures) {
    last = std::max({last, closure.from, closure.to});
    if (WorstSigmaM(closure) < kFirmSigmaM) is_end[closure.from] = is_end[closure.to] = 1;
  }
  is_end[last] = 1;  // beyond it nothing strains the steps
  for (int k = 0; k + 1 < keys.size(); ++k) {
    if (keys.sequential[k].between_sessions) is_end[k] = is_end[k + 1] = 1;
  }
  std::vector<StretchOfSteps> stretches;
  std::vector<int> inside(keys.size(), -1);  // of keyframes, the stretch that they do not end
  int first = 0;
  for (int k = 1; k < keys.size(); ++k) {
    if (is_end[k] == 0) continue;
    for (int i = first + 1; i < k; ++i) inside[i] = static_cast<int>(stretches.size());
    stretches.push_back({first, k, 0});
    first = k;
  }
  for (const RelativePoseConstraint& closure : keys.closures) {
    const int from = inside[closure.from], to = inside[closure.to];
    if (from >= 0) ++stretches[from].num_closures_inside;
    if (to >= 0 && to != from) ++stretches[to].num_closures_inside;
  }
  return stretches;
}

std::vector<int> MostStrainedSteps(const ScanSurfaces& surfaces,
                                   const std::vector<Pose2>& world_from_robot,
                                   const KeyframeGraph& keys, KeyframeGraph* marked) {
  const double chi2_of_graph = GraphChi2(keys);
  std::vector<int> steps;
  for (const StretchOfSteps& stretch : StretchesBetweenClosures(keys)) {
    const double chi2 = StepsChi2(keys, stretch.first, stretch.end);
    const double most_chi2 =
        MostStrain(chi2_of_graph - chi2, keys.closures.size(), stretch.num_closures_inside);
    if (chi2 <= most_chi2) continue;
    const int step = MarkWorstEdge(surfaces, world_from_robot, stretch.first, stretch.end, marked);
    const double others_chi2 = chi2 - StepsChi2(keys, step, step + 1);
    if (marked->sequential[step].evidence > 0.0 && others_chi2 > most_chi2) steps.push_back(step);
  }
  return steps;
}

}  // namespace plumbline
