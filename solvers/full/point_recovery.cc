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

// How far a point stays from its line that costs rho(d^2 / v) / 2 at distance d, v the surface's
// variance, while its beam ended at another distance.
class RemainingDistance {
 public:
  RemainingDistance(double distance_m, double beam_variance, double surface_variance,
                    const GemanMcClure& loss)
      : distance_(distance_m),
        scale_(loss.scale_squared * surface_variance),
        weight_(beam_variance * scale_ * loss.scale_squared),
        start_(distance_m * surface_variance / (surface_variance + beam_variance)) {}

  double Solve() const {
    constexpr int kMaxSteps = 20;
    constexpr double kToleranceM = 1e-5;
    // Most points want two steps: not to ask after the first one is faster.
    double remaining = start_ + StepFrom(start_);
    double step = kToleranceM;
    for (int i = 1; i < kMaxSteps && std::abs(step) >= kToleranceM; ++i) {
      step = StepFrom(remaining);
      remaining += step;
    }
    return IsBetter(remaining) ? remaining : distance_;
  }

 private:
  // A point at distance d has the information 1 / v (scale / (scale + d^2))^2, scale = a v. With
  // S = (scale + d^2)^2 it stays at d = distance S / (S + weight): Newton's step towards that.
  // Where the right-hand side rises steeply, only to substitute it for d is sure not to go beyond
  // the nearest solution.
  double StepFrom(double d) const {
    const double sum = scale_ + d * d;
    const double total = sum * sum + weight_;
    const double gap = distance_ * sum * sum - d * total;
    const double slope = 4.0 * distance_ * weight_ * d * sum;  // times total^2
    const double squared = total * total;
    return gap * total / (2.0 * slope > squared ? squared : squared - slope);
  }

  // Than to stay where the beam ended: the cost of having moved against the difference of the
  // losses, scale a (distance^2 - d^2) / ((scale + distance^2) (scale + d^2)).
  bool IsBetter(double d) const {
    const double d2 = d * d, distance2 = distance_ * distance_;
    // Up to here the loss is convex in the distance: there is no other minimum.
    if (3.0 * distance2 <= scale_) return true;
    const double moved = distance_ - d;
    return moved * moved * (scale_ + d2) * (scale_ + distance2) < weight_ * (distance2 - d2);
  }

  double distance_, scale_, weight_, start_;
};

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
    const Eigen::Vector2d measured = frame * (range_m * direction + returns.laser_in_robot());
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
        distance - RemainingDistance(distance, variance, noise.surface_variance, loss).Solve();
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
    const Eigen::Vector2d measured = frame * in_robot;
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
