#include "plumbline/solvers/landmarks/landmark_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "plumbline/factors/robust_loss.h"

namespace plumbline {
namespace {

constexpr std::size_t kScansPerChunk = 64;

void AddTerm(const Eigen::Vector2d& direction, double weight, LineLandmark* landmark) {
  landmark->shape_xx += weight * direction.x() * direction.x();
  landmark->shape_xy += weight * direction.x() * direction.y();
  landmark->shape_yy += weight * direction.y() * direction.y();
}

}  // namespace

std::vector<AdjacentLandmarks> FindAdjacentLandmarks(const SlamGraph& graph,
                                                     const MeasuredSurface& surface,
                                                     const LineLandmarks& landmarks,
                                                     double max_gap_m, ThreadPool* pool) {
  const std::size_t num_scans = graph.num_scans();
  // Pairs, the smaller id in the upper half, with repetitions.
  std::vector<std::vector<std::uint64_t>> parts(ThreadPool::NumChunks(num_scans, kScansPerChunk));
  const auto find_in_scan = [&](int scan_id, std::vector<std::uint64_t>* pairs) {
    const ScanEntry& scan = graph.scan(scan_id);
    const std::size_t first_pair = pairs->size();
    std::size_t last = 0;
    int last_landmark = LineLandmarks::kNone;
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const int landmark = landmarks.landmark_of_return[r];
      if (landmark == LineLandmarks::kNone) continue;
      if (last_landmark != LineLandmarks::kNone && landmark != last_landmark &&
          (surface.points[r] - surface.points[last]).norm() <= max_gap_m) {
        const auto low = static_cast<std::uint64_t>(std::min(landmark, last_landmark));
        const auto high = static_cast<std::uint64_t>(std::max(landmark, last_landmark));
        pairs->push_back(low << 32 | high);
      }
      last = r;
      last_landmark = landmark;
    }
    // A scan counts once, however often it goes to and fro between two landmarks.
    std::sort(pairs->begin() + first_pair, pairs->end());
    pairs->erase(std::unique(pairs->begin() + first_pair, pairs->end()), pairs->end());
  };
  pool->ForEachChunk(num_scans, kScansPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) {
                         find_in_scan(static_cast<int>(s), &parts[chunk]);
                       }
                     });
  std::vector<std::uint64_t> pairs;
  for (const std::vector<std::uint64_t>& part : parts) {
    pairs.insert(pairs.end(), part.begin(), part.end());
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<AdjacentLandmarks> adjacent;
  for (const std::uint64_t pair : pairs) {
    const int first = static_cast<int>(pair >> 32), second = static_cast<int>(pair & 0xffffffff);
    if (adjacent.empty() || adjacent.back().first != first || adjacent.back().second != second) {
      adjacent.push_back({first, second, 0});
    }
    ++adjacent.back().num_scans;
  }
  return adjacent;
}

void SetShapeTerms(const std::vector<AdjacentLandmarks>& adjacent, const ShapeOptions& options,
                   double margin_rad, std::vector<LineLandmark>* landmarks) {
  for (LineLandmark& landmark : *landmarks)
    landmark.shape_xx = landmark.shape_xy = landmark.shape_yy = 0.0;
  const double max_sine = std::sin(margin_rad);
  const GemanMcClure loss = GemanMcClure::FromGate(options.robust_gate_sigmas);
  const double information = 1.0 / (options.sigma_rad * options.sigma_rad);
  for (const AdjacentLandmarks& pair : adjacent) {
    LineLandmark& a = (*landmarks)[pair.first];
    LineLandmark& b = (*landmarks)[pair.second];
    const Eigen::Vector2d tangent_a(-a.normal.y(), a.normal.x());
    const Eigen::Vector2d tangent_b(-b.normal.y(), b.normal.x());
    const double cosine = a.normal.dot(b.normal), sine = a.normal.dot(tangent_b);
    const bool parallel = std::abs(sine) <= max_sine;
    if (!parallel && std::abs(cosine) > max_sine) continue;
    const double error = parallel ? sine : cosine;
    const double weight = pair.num_scans * information * loss.Weight(error * error * information);
    AddTerm(parallel ? tangent_b : b.normal, weight, &a);
    AddTerm(parallel ? tangent_a : a.normal, weight, &b);
  }
}

}  // namespace plumbline
