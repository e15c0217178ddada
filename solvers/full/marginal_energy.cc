#include "plumbline/solvers/full/marginal_energy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/over_peers.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/full/scan_chunk.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"
#include "plumbline/solvers/terms/pose_terms.h"

namespace plumbline {
namespace {

// Cost of the returns of one scan, given the lines of the map.
double ScanCost(const SlamGraph& graph, const std::vector<double>& poses, int scan_id,
                const TangentLines& lines, const FactorOptions& factors) {
  const ScanEntry& scan = graph.scan(scan_id);
  const Pose2 pose(&poses[3 * scan.pose]);
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
  const SurfaceNoise noise = NoiseOf(factors);
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  double cost = 0.0;
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    if (!lines.HasLine(r)) {
      cost += 0.5 * loss.ClutterRho();
      continue;
    }
    const TangentLine& line = lines[r];
    const Eigen::Vector2d normal(c * line.normal_x + s * line.normal_y,
                                 -s * line.normal_x + c * line.normal_y);
    const double variance =
        noise.surface_variance +
        noise.BeamVariance(returns.Range(r), returns.DirectionInRobot(r), normal);
    const double distance = normal.dot(returns.PointInRobot(r)) + line.normal_x * pose.x +
                            line.normal_y * pose.y - line.offset;
    cost += 0.5 * std::min(loss.Rho(distance * distance / variance), loss.ClutterRho());
  }
  return cost;
}

}  // namespace

double MarginalEnergy(const SlamGraph& graph, const std::vector<double>& poses,
                      const TangentLines& lines, const FactorOptions& factors, ThreadPool* pool) {
  std::vector<double> costs(ThreadPool::NumChunks(graph.num_scans(), kScansPerChunk), 0.0);
  pool->ForEachChunk(graph.num_scans(), kScansPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) {
                         costs[chunk] +=
                             ScanCost(graph, poses, static_cast<int>(s), lines, factors);
                       }
                     });
  double of_returns = 0.0;
  for (const double cost : costs) of_returns += cost;
  return PoseTerms(graph, factors).Cost(poses) + FactorPointCost(graph, poses) +
         SumOverPeers(graph.peers(), of_returns);
}

double MarginalEnergy(const SlamGraph& graph, const std::vector<double>& poses,
                      const MeasuredSurface& surface, const SolverOptions& options,
                      ThreadPool* pool) {
  return MarginalEnergy(
      graph, poses,
      LinesFromRadius(graph, poses, surface, options.association, FineRadius(options), pool),
      options.factors, pool);
}

}  // namespace plumbline
