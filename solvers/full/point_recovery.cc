#include "plumbline/solvers/full/point_recovery.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/core/over_peers.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/association/associations.h"
#include "plumbline/solvers/full/scan_chunk.h"

namespace plumbline {
namespace {

// Distance [m] from its line that a point keeps whose beam ended at `distance` from it.
double RemainingDistance(double distance, double beam_variance, double surface_variance,
                         const GemanMcClure& loss) {
  constexpr int kMaxIterations = 20;
  constexpr double kToleranceM = 1e-5;
  // A point at distance d has the information 1 / v (a v / (a v + d^2))^2, a v = scale.
  const double scale = loss.scale_squared * surface_variance;
  const double weight = beam_variance * scale * loss.scale_squared;
  double remaining = distance * surface_variance / (surface_variance + beam_variance);
  for (int i = 0; i < kMaxIterations; ++i) {
    const double sum_squared = std::pow(scale + remaining * remaining, 2);
    const double next = distance * sum_squared / (sum_squared + weight);
    const bool settled = std::abs(next - remaining) <= kToleranceM;
    remaining = next;
    if (settled) break;
  }
  // Up to here the loss is convex in the distance: there is no other minimum.
  if (3.0 * distance * distance <= scale) return remaining;
  const double moved = distance - remaining;
  const double cost_on_line =
      moved * moved / beam_variance + loss.Term(remaining, surface_variance).rho;
  return cost_on_line < loss.Term(distance, surface_variance).rho ? remaining : distance;
}

// Takes one point into account; `mean_m` is a sum. Lengths that are not finite go to the last bins.
void AddPoint(double moved_m, double beam_sigmas, PointDisplacements* displacements) {
  using Bins = PointDisplacements;
  int sigma_bin = Bins::kNumSigmaBins - 1, octave = Bins::kNumOctaves - 1;
  if (beam_sigmas < sigma_bin * Bins::kSigmasPerBin) {
    sigma_bin = static_cast<int>(beam_sigmas / Bins::kSigmasPerBin);
  }
  if (moved_m < Bins::kFirstOctaveM) {
    octave = 0;
  } else if (std::isfinite(moved_m)) {
    octave = std::min(octave, 1 + std::ilogb(moved_m / Bins::kFirstOctaveM));
  }
  displacements->mean_m += moved_m;
  displacements->max_m = std::max(displacements->max_m, moved_m);
  displacements->max_beam_sigmas = std::max(displacements->max_beam_sigmas, beam_sigmas);
  ++displacements->sigma_counts[sigma_bin];
  ++displacements->octave_counts[octave];
}

void RecoverScan(const SlamGraph& graph, const std::vector<double>& poses,
                 const TangentLines& lines, const FactorOptions& factors, int scan_id,
                 std::vector<double>* points, PointDisplacements* displacements) {
  const ScanEntry& scan = graph.scan(scan_id);
  const PoseFrame frame(&poses[3 * scan.pose]);
  const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
  const SurfaceNoise noise = NoiseOf(factors);
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    const double range_m = returns.Range(r);
    const Eigen::Vector2d direction = returns.DirectionInRobot(r);
    const Eigen::Vector2d measured =
        frame.Rotate(range_m * direction + returns.laser_in_robot()) + frame.translation();
    Eigen::Map<Eigen::Vector2d> point(&(*points)[2 * r]);
    const TangentLine& line = lines[r];
    const Eigen::Vector2d normal(line.normal_x, line.normal_y);
    if (!lines.HasLine(r)) {
      point = measured;
      AddPoint(0.0, 0.0, displacements);
      continue;
    }
    const Eigen::Vector2d covariance_normal =
        noise.BeamCovarianceTimes(range_m, frame.Rotate(direction), normal);
    const double variance = normal.dot(covariance_normal);
    const double distance = normal.dot(measured) - line.offset;
    const double moved =
        distance - RemainingDistance(distance, variance, noise.surface_variance, loss);
    const double per_variance = moved / variance;
    point = measured - covariance_normal * per_variance;
    AddPoint(covariance_normal.norm() * std::abs(per_variance),
             std::sqrt(variance) * std::abs(per_variance), displacements);
  }
}

void Add(const PointDisplacements& part, PointDisplacements* total) {
  total->mean_m += part.mean_m;
  total->max_m = std::max(total->max_m, part.max_m);
  total->max_beam_sigmas = std::max(total->max_beam_sigmas, part.max_beam_sigmas);
  for (int i = 0; i < part.kNumSigmaBins; ++i) total->sigma_counts[i] += part.sigma_counts[i];
  for (int i = 0; i < part.kNumOctaves; ++i) total->octave_counts[i] += part.octave_counts[i];
}

void AddPartsOfPeers(const Peers& peers, PointDisplacements* total) {
  const std::vector<std::vector<PointDisplacements>> to_rank(peers.size(), {*total});
  *total = PointDisplacements();
  for (const std::vector<PointDisplacements>& part : ExchangeValues(peers, to_rank)) {
    Add(part.front(), total);
  }
}

void MeasureScan(const SlamGraph& graph, const MapState& state, const SurfaceNoise& noise,
                 int scan_id, PointDisplacements* displacements) {
  const ScanEntry& scan = graph.scan(scan_id);
  const PoseFrame frame(&state.poses[3 * scan.pose]);
  const Eigen::Vector2d laser = graph.laser(scan.laser).robot_from_laser.translation();
  const double range_information = 1.0 / noise.range_variance;
  const double bearing_information = 1.0 / noise.bearing_variance;
  const ScanReturns returns = graph.ReturnsOfScan(scan_id);
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    const Eigen::Vector2d in_robot = returns.PointInRobot(r);
    const Eigen::Vector2d measured = frame.Rotate(in_robot) + frame.translation();
    const Eigen::Vector2d beam = frame.Rotate(in_robot - laser);
    const Eigen::Vector2d moved =
        Eigen::Vector2d(state.points[2 * r], state.points[2 * r + 1]) - measured;
    const double per_range_squared = 1.0 / beam.squaredNorm();
    const double along = moved.dot(beam);
    const double turned_rad = (moved.x() * beam.y() - moved.y() * beam.x()) * per_range_squared;
    const double beam_sigmas = std::sqrt(along * along * per_range_squared * range_information +
                                         turned_rad * turned_rad * bearing_information);
    AddPoint(moved.norm(), beam_sigmas, displacements);
  }
}

// Calls measure(scan, displacements) for all scans, and adds up what it adds to these.
template <typename Measure>
PointDisplacements SumOverScans(const SlamGraph& graph, ThreadPool* pool, const Measure& measure) {
  const std::size_t num_scans = graph.num_scans();
  std::vector<PointDisplacements> parts(ThreadPool::NumChunks(num_scans, kScansPerChunk));
  pool->ForEachChunk(num_scans, kScansPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) {
                         measure(static_cast<int>(s), &parts[chunk]);
                       }
                     });
  PointDisplacements total;
  for (const PointDisplacements& part : parts) Add(part, &total);
  return total;
}

// Of all processes, with the mean in place of the sum.
PointDisplacements Total(const SlamGraph& graph, PointDisplacements own) {
  if (graph.peers() != nullptr) AddPartsOfPeers(*graph.peers(), &own);
  const double num_returns = SumOverPeers(graph.peers(), static_cast<double>(graph.num_returns()));
  own.mean_m /= std::max(1.0, num_returns);
  return own;
}

}  // namespace

std::vector<double> RecoverPoints(const SlamGraph& graph, const std::vector<double>& poses,
                                  const TangentLines& lines, const FactorOptions& factors,
                                  ThreadPool* pool, PointDisplacements* displacements) {
  std::vector<double> points(2 * graph.num_returns());
  const PointDisplacements moved =
      SumOverScans(graph, pool, [&](int scan, PointDisplacements* of_chunk) {
        RecoverScan(graph, poses, lines, factors, scan, &points, of_chunk);
      });
  if (displacements != nullptr) *displacements = Total(graph, moved);
  return points;
}

PointDisplacements MeasureDisplacements(const SlamGraph& graph, const MapState& state,
                                        const FactorOptions& factors, ThreadPool* pool) {
  const SurfaceNoise noise = NoiseOf(factors);
  return Total(graph, SumOverScans(graph, pool, [&](int scan, PointDisplacements* of_chunk) {
                 MeasureScan(graph, state, noise, scan, of_chunk);
               }));
}

}  // namespace plumbline
