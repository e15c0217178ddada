#include "plumbline/solvers/landmarks/landmark_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/shape_factor.h"

namespace plumbline {
namespace {

// What the pose observed of the landmark; null if nothing.
LineObservation* FindObservation(int pose, int landmark, LineObservations* observations) {
  const auto begin = observations->of_pose.begin();
  const auto last = begin + observations->first_of_pose[pose + 1];
  const auto found = std::lower_bound(
      begin + observations->first_of_pose[pose], last, landmark, [&](int observation, int wanted) {
        return observations->observations[observation].landmark < wanted;
      });
  if (found == last || observations->observations[*found].landmark != landmark) return nullptr;
  return &observations->observations[*found];
}

void AddTerm(const Eigen::Vector2d& direction, double weight, LineObservation* observation) {
  observation->xx += static_cast<float>(weight * direction.x() * direction.x());
  observation->xy += static_cast<float>(weight * direction.x() * direction.y());
  observation->yy += static_cast<float>(weight * direction.y() * direction.y());
}

}  // namespace

std::vector<AdjacentLandmarks> FindAdjacentLandmarks(const SlamGraph& graph,
                                                     const LineLandmarks& landmarks,
                                                     ThreadPool* pool) {
  constexpr std::size_t kScansPerChunk = 64;
  const std::size_t num_scans = graph.num_scans();
  std::vector<std::vector<AdjacentLandmarks>> parts(
      ThreadPool::NumChunks(num_scans, kScansPerChunk));
  const auto find_in_scan = [&](int scan_id, std::vector<AdjacentLandmarks>* pairs) {
    const ScanEntry& scan = graph.scan(scan_id);
    const ScanReturns returns = graph.ReturnsOfScan(scan_id);
    const std::size_t first_pair = pairs->size();
    std::size_t last = 0;
    int last_landmark = LineLandmarks::kNone;
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const int landmark = landmarks.landmark_of_return[r];
      if (landmark == LineLandmarks::kNone) continue;
      if (last_landmark != LineLandmarks::kNone && landmark != last_landmark &&
          (returns.PointInRobot(r) - returns.PointInRobot(last)).norm() <= kShapeRegionM) {
        pairs->push_back(
            {scan.pose, std::min(landmark, last_landmark), std::max(landmark, last_landmark)});
      }
      last = r;
      last_landmark = landmark;
    }
    // A scan counts once, however often it goes to and fro between two landmarks.
    const auto ids = [](const AdjacentLandmarks& pair) {
      return std::make_pair(pair.first, pair.second);
    };
    std::sort(pairs->begin() + first_pair, pairs->end(),
              [&](const auto& a, const auto& b) { return ids(a) < ids(b); });
    pairs->erase(std::unique(pairs->begin() + first_pair, pairs->end(),
                             [&](const auto& a, const auto& b) { return ids(a) == ids(b); }),
                 pairs->end());
  };
  pool->ForEachChunk(num_scans, kScansPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) {
                         find_in_scan(static_cast<int>(s), &parts[chunk]);
                       }
                     });
  std::vector<AdjacentLandmarks> adjacent;
  for (const std::vector<AdjacentLandmarks>& part : parts) {
    adjacent.insert(adjacent.end(), part.begin(), part.end());
  }
  return adjacent;
}

void AddShapeTerms(const std::vector<AdjacentLandmarks>& adjacent, double gate_sigmas,
                   const std::vector<LineLandmark>& landmarks, const std::vector<PoseFrame>& frames,
                   LineObservations* observations) {
  const double max_sine = std::sin(kShapeMarginRad);
  const GemanMcClure loss = GemanMcClure::FromGate(gate_sigmas);
  const double information = 1.0 / (kShapeSigmaRad * kShapeSigmaRad);
  for (const AdjacentLandmarks& pair : adjacent) {
    const PoseFrame& frame = frames[pair.pose];
    const Eigen::Vector2d a = frame.RotateBack(landmarks[pair.first].normal);
    const Eigen::Vector2d b = frame.RotateBack(landmarks[pair.second].normal);
    const double cosine = a.dot(b), sine = a.dot(TurnedLeft(b));
    const bool parallel = std::abs(sine) <= max_sine;
    if (!parallel && std::abs(cosine) > max_sine) continue;
    // b, turned by the right angles that bring it next to a.
    const Eigen::Vector2d turned =
        parallel ? std::copysign(1.0, cosine) * b : std::copysign(1.0, sine) * TurnedLeft(b);
    const Eigen::Vector2d middle = (a + turned).normalized();
    // Held-out returns alone are no observation.
    LineObservation* of_a = FindObservation(pair.pose, pair.first, observations);
    LineObservation* of_b = FindObservation(pair.pose, pair.second, observations);
    if (of_a == nullptr || of_b == nullptr) continue;
    const double weight = information * loss.Weight((a - turned).squaredNorm() * information);
    AddTerm(TurnedLeft(middle), 2.0 * weight, of_a);
    AddTerm(parallel ? TurnedLeft(middle) : middle, 2.0 * weight, of_b);
  }
}

}  // namespace plumbline
