#include "plumbline/solvers/marginal_energy.h"

#include <cmath>
#include <cstddef>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/pose_terms.h"

namespace plumbline {
namespace {

constexpr std::size_t kScansPerChunk = 16;

// Cost of the returns of one scan, given the lines of the map.
double ScanCost(const SlamGraph& graph, int scan_id, const std::vector<TangentLine>& lines,
                const FactorOptions& factors) {
  const ScanEntry& scan = graph.scan(scan_id);
  const LaserReturns& returns = graph.returns();
  const double laser_yaw = graph.WorldFromLaser(scan_id).yaw;
  const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
  const double sigma_m = factors.manifold.sigma_m;
  double cost = 0.0;
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    const TangentLine& line = lines[r];
    if (!Associations::HasLine(line)) {
      cost += 0.5 * loss.scale_squared;
      continue;
    }
    const double bearing = laser_yaw + returns.bearing_rad[r];
    const double c = std::cos(bearing), s = std::sin(bearing);
    const double along = (line.normal_x * c + line.normal_y * s) * factors.beam.sigma_range_m;
    const double across = (-line.normal_x * s + line.normal_y * c) * returns.range_m[r] *
                          factors.beam.sigma_bearing_rad;
    const double variance = sigma_m * sigma_m + along * along + across * across;
    const double distance = line.normal_x * graph.points()[2 * r] +
                            line.normal_y * graph.points()[2 * r + 1] - line.offset;
    cost += 0.5 * loss.Rho(distance * distance / variance);
  }
  return cost;
}

}  // namespace

double MarginalEnergy(const std::vector<Eigen::Vector2f>& normals, const FactorOptions& factors,
                      const AssociationOptions& association, double radius_m, ThreadPool* pool,
                      SlamGraph* graph) {
  const std::vector<double> kept_points = graph->points();
  graph->ResetPointsFromPoses();
  const std::vector<TangentLine> lines =
      LinesFromRadius(*graph, normals, association, radius_m, pool);
  std::vector<double> costs(ThreadPool::NumChunks(graph->num_scans(), kScansPerChunk), 0.0);
  pool->ForEachChunk(graph->num_scans(), kScansPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) {
                         costs[chunk] += ScanCost(*graph, static_cast<int>(s), lines, factors);
                       }
                     });
  double total = PoseTerms(*graph, factors).Cost(graph->poses());
  for (const double cost : costs) total += cost;
  graph->points() = kept_points;
  return total;
}

}  // namespace plumbline
