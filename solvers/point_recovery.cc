#include "plumbline/solvers/point_recovery.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/association/associations.h"

namespace plumbline {
namespace {

constexpr std::size_t kScansPerChunk = 16;

// Distance [m] from its line that a point keeps whose beam ended at `distance` from it.
double RemainingDistance(double distance, double beam_variance, double surface_variance,
                         const GemanMcClure& loss) {
  constexpr int kMaxIterations = 20;
  constexpr double kToleranceM = 1e-7;
  double remaining = distance * surface_variance / (surface_variance + beam_variance);
  for (int i = 0; i < kMaxIterations; ++i) {
    const double weight = loss.Weight(remaining * remaining / surface_variance);
    const double next = distance * surface_variance / (surface_variance + weight * beam_variance);
    const bool settled = std::abs(next - remaining) <= kToleranceM;
    remaining = next;
    if (settled) break;
  }
  const double moved = distance - remaining;
  const double cost_on_line =
      moved * moved / beam_variance + loss.Rho(remaining * remaining / surface_variance);
  return cost_on_line < loss.Rho(distance * distance / surface_variance) ? remaining : distance;
}

// The points of one scan; adds up displacements, `mean_m` as a sum.
void RecoverScan(const MeasuredSurface& surface, const std::vector<TangentLine>& lines,
                 const FactorOptions& factors, int scan_id, SlamGraph* graph,
                 PointDisplacements* displacements) {
  const ScanEntry& scan = graph->scan(scan_id);
  const Pose2 pose = graph->WorldFromRobot(scan.pose);
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  const Eigen::Vector2d laser = graph->laser(scan.laser).robot_from_laser.translation();
  const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
  const SurfaceNoise noise = NoiseOf(factors);
  const auto to_world = [&](const Eigen::Vector2d& v) {
    return Eigen::Vector2d(c * v.x() - s * v.y(), s * v.x() + c * v.y());
  };
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    const Eigen::Vector2d in_robot = surface.points[r].cast<double>();
    Eigen::Map<Eigen::Vector2d> point(&graph->points()[2 * r]);
    point = to_world(in_robot) + pose.translation();
    if (!Associations::HasLine(lines[r])) continue;
    const Eigen::Vector2d normal(lines[r].normal_x, lines[r].normal_y);
    const Eigen::Vector2d beam = to_world(in_robot - laser);
    const double variance = noise.BeamVariance(beam, normal);
    const double distance = normal.dot(point) - lines[r].offset;
    const double moved =
        distance - RemainingDistance(distance, variance, noise.surface_variance, loss);
    // C n, by the beam's own axes.
    const Eigen::Vector2d axis = beam.normalized();
    const Eigen::Vector2d side(-axis.y(), axis.x());
    const Eigen::Vector2d covariance_normal =
        noise.range_variance * axis.dot(normal) * axis +
        noise.bearing_variance * beam.squaredNorm() * side.dot(normal) * side;
    const Eigen::Vector2d step = covariance_normal * (moved / variance);
    point -= step;
    displacements->mean_m += step.norm();
    displacements->max_m = std::max(displacements->max_m, step.norm());
    displacements->max_beam_sigmas =
        std::max(displacements->max_beam_sigmas, std::abs(moved) / std::sqrt(variance));
  }
}

}  // namespace

PointDisplacements RecoverPoints(const MeasuredSurface& surface,
                                 const std::vector<TangentLine>& lines,
                                 const FactorOptions& factors, ThreadPool* pool, SlamGraph* graph) {
  const std::size_t num_scans = graph->num_scans();
  std::vector<PointDisplacements> parts(ThreadPool::NumChunks(num_scans, kScansPerChunk));
  pool->ForEachChunk(
      num_scans, kScansPerChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
          RecoverScan(surface, lines, factors, static_cast<int>(s), graph, &parts[chunk]);
        }
      });
  PointDisplacements total;
  for (const PointDisplacements& part : parts) {
    total.mean_m += part.mean_m;
    total.max_m = std::max(total.max_m, part.max_m);
    total.max_beam_sigmas = std::max(total.max_beam_sigmas, part.max_beam_sigmas);
  }
  total.mean_m /= static_cast<double>(std::max<std::size_t>(1, graph->num_returns()));
  return total;
}

}  // namespace plumbline
