#include "plumbline/solvers/acceptance/contradicted_steps.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/solvers/interface/acceptance.h"
#include "plumbline/solvers/terms/pose_edges.h"

namespace plumbline {
namespace {

constexpr double kContradictedSigmas = 6.0;
constexpr double kLeapM = 0.2;
constexpr double kLeapRad = 0.2;
constexpr double kKeptSigmas = 3.0;
constexpr int kReachPoses = 16;

double SigmasOf(const PoseEdge& edge, const std::vector<double>& poses) {
  Eigen::Vector3d error;
  edge.residual.Evaluate(&poses[3 * edge.from], &poses[3 * edge.to], error.data(), nullptr,
                         nullptr);
  return error.norm();
}

bool IsLeap(const PoseEdge& edge, const std::vector<double>& poses) {
  const Pose2 step = Between(Pose2(&poses[3 * edge.from]), Pose2(&poses[3 * edge.to]));
  const Pose2& odometry = edge.residual.a_from_b;
  return std::hypot(step.x - odometry.x, step.y - odometry.y) > kLeapM ||
         std::abs(NormalizeAngle(step.yaw - odometry.yaw)) > kLeapRad;
}

bool IsNear(const WorseStretch& stretch, int pose) {
  return pose >= stretch.first - kReachPoses && pose <= stretch.last + kReachPoses;
}

}  // namespace

std::vector<DownweightedStep> StepsToDownweight(const SlamGraph& graph,
                                                const FactorOptions& factors,
                                                const std::vector<double>& seed,
                                                const std::vector<double>& state,
                                                const std::vector<WorseStretch>& worse) {
  const std::vector<PoseEdge> motions = PoseEdges(graph, factors).motions;
  std::vector<DownweightedStep> contradicted;
  std::vector<WorseStretch> spoilt = worse;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const double sigmas = SigmasOf(motions[i], seed);
    if (sigmas > kContradictedSigmas && IsLeap(motions[i], seed)) {
      contradicted.push_back({i, sigmas});
    } else if (sigmas <= kKeptSigmas && SigmasOf(motions[i], state) > kContradictedSigmas) {
      spoilt.push_back({motions[i].from, motions[i].to});
    }
  }
  std::vector<DownweightedStep> downweighted;
  for (const DownweightedStep& step : contradicted) {
    const bool spoils = std::any_of(spoilt.begin(), spoilt.end(), [&](const WorseStretch& stretch) {
      return IsNear(stretch, motions[step.step].to);
    });
    if (spoils) downweighted.push_back(step);
  }
  return downweighted;
}

}  // namespace plumbline
