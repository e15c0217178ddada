#include "plumbline/solvers/loop_closure/strained_stretches.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>

#include "plumbline/solvers/loop_closure/loop_acceptance.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

// Whether a closure holds both coordinates. One along a corridor gives way like the steps do.
bool IsFirm(const RelativePoseConstraint& closure) {
  constexpr double kFirmM = 0.1;
  const Eigen::Matrix2d position = closure.covariance.topLeftCorner<2, 2>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(position, Eigen::EigenvaluesOnly);
  return axes.eigenvalues()(1) < kFirmM * kFirmM;
}

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

double MostStrain(double chi2_of_others, std::size_t num_closures, int num_ends_inside) {
  // What sound drives are off by: few closures may fit better by chance.
  constexpr double kLeastShare = 0.01;
  constexpr double kDegreesOfFreedom = 3.0;  // of a closure
  const double share_of_allowed =
      chi2_of_others / std::max(1.0, kDegreesOfFreedom * static_cast<double>(num_closures));
  return (LoopAcceptance::kMaxEdgeChi2 + kDegreesOfFreedom * num_ends_inside) *
         std::clamp(share_of_allowed, kLeastShare, 1.0);
}

std::vector<StretchOfSteps> StretchesBetweenClosures(const KeyframeGraph& keys) {
  std::vector<char> is_end(keys.size(), 0);
  std::vector<int> num_ends(keys.size(), 0);  // of closures that are not firm
  for (const RelativePoseConstraint& closure : keys.closures) {
    for (const int key : {closure.from, closure.to}) {
      if (IsFirm(closure)) {
        is_end[key] = 1;
      } else {
        ++num_ends[key];
      }
    }
  }
  for (int k = 0; k + 1 < keys.size(); ++k) {
    if (keys.sequential[k].between_sessions) is_end[k] = is_end[k + 1] = 1;
  }
  std::vector<StretchOfSteps> stretches;
  StretchOfSteps stretch;
  for (int k = 1; k < keys.size(); ++k) {
    if (is_end[k] == 0) {
      stretch.num_ends_inside += num_ends[k];
      continue;
    }
    stretch.end = k;
    stretches.push_back(stretch);
    stretch = {k, k, 0};
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
        MostStrain(chi2_of_graph - chi2, keys.closures.size(), stretch.num_ends_inside);
    if (chi2 <= most_chi2) continue;
    const int step = MarkWorstEdge(surfaces, world_from_robot, stretch.first, stretch.end, marked);
    const double others_chi2 = chi2 - StepsChi2(keys, step, step + 1);
    if (marked->sequential[step].evidence > 0.0 && others_chi2 > most_chi2) steps.push_back(step);
  }
  return steps;
}

}  // namespace plumbline
