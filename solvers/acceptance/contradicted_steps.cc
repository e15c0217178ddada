#include "plumbline/solvers/acceptance/contradicted_steps.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/solvers/interface/acceptance.h"
#include "plumbline/solvers/terms/pose_edges.h"

namespace plumbline {
namespace {

// Least error of a broken step [standard deviations]. On fr079, a step of 15 moves the pose beside
// it by 3 mm only; a robot that was carried contradicts its step by hundreds.
constexpr double kBrokenSigmas = 30.0;
// Largest error of a step that a state keeps [standard deviations].
constexpr double kKeptSigmas = 3.0;
constexpr int kReachPoses = 16;

double SigmasOf(const PoseEdge& edge, const std::vector<double>& poses) {
  Eigen::Vector3d error;
  edge.residual.Evaluate(&poses[3 * edge.from], &poses[3 * edge.to], error.data(), nullptr,
                         nullptr);
  return error.norm();
}

bool IsContradicted(const PoseEdge& edge, const std::vector<double>& poses, double least_sigmas) {
  if (!(SigmasOf(edge, poses) > least_sigmas)) return false;
  const Pose2 step = Between(Pose2(&poses[3 * edge.from]), Pose2(&poses[3 * edge.to]));
  const Pose2& odometry = edge.residual.a_from_b;
  return std::hypot(step.x - odometry.x, step.y - odometry.y) > kLeapM ||
         std::abs(NormalizeAngle(step.yaw - odometry.yaw)) > kLeapRad;
}

bool IsNear(const WorseStretch& stretch, int pose) {
  return pose >= stretch.first - kReachPoses && pose <= stretch.last + kReachPoses;
}

}  // namespace

StepsAgainstState FindStepsAgainst(const SlamGraph& graph, const FactorOptions& factors,
                                   const std::vector<double>& seed,
                                   const std::vector<double>& state,
                                   const std::vector<WorseStretch>& worse) {
  const std::vector<PoseEdge> motions = PoseEdges(graph, factors).motions;
  std::vector<std::size_t> contradicted;
  std::vector<WorseStretch> spoilt = worse;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (IsContradicted(motions[i], seed, kLeapSigmas)) {
      contradicted.push_back(i);
    } else if (SigmasOf(motions[i], seed) <= kKeptSigmas &&
               SigmasOf(motions[i], state) > kLeapSigmas) {
      spoilt.push_back({motions[i].from, motions[i].to});
    }
  }
  StepsAgainstState against;
  for (const std::size_t i : contradicted) {
    const bool is_broken = IsContradicted(motions[i], state, kBrokenSigmas);
    const bool spoils = std::any_of(spoilt.begin(), spoilt.end(), [&](const WorseStretch& stretch) {
      return IsNear(stretch, motions[i].to);
    });
    if (is_broken) against.refute_state = true;
    if (is_broken || spoils) against.steps.push_back({i, SigmasOf(motions[i], seed)});
  }
  return against;
}

std::vector<DownweightedStep> FindBrokenSteps(const SlamGraph& graph, const FactorOptions& factors,
                                              const std::vector<double>& seed,
                                              const std::vector<int>& first_poses_after) {
  if (first_poses_after.empty() || seed.size() != graph.initial_poses().size()) return {};
  const std::vector<PoseEdge> motions = PoseEdges(graph, factors).motions;
  std::vector<DownweightedStep> steps;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const bool is_near =
        std::any_of(first_poses_after.begin(), first_poses_after.end(), [&](int pose) {
          return IsNear({pose, pose}, motions[i].to);
        });
    if (is_near && IsContradicted(motions[i], seed, kLeapSigmas)) {
      steps.push_back({i, SigmasOf(motions[i], seed)});
    }
  }
  return steps;
}

}  // namespace plumbline
