#include "plumbline/solvers/landmarks/fit_landmark_lines.h"

#include <cstddef>
#include <numeric>

#include "plumbline/core/line_fit.h"
#include "plumbline/solvers/landmarks/world_moments.h"

namespace plumbline {

namespace {

constexpr std::size_t kLandmarksPerChunk = 256;

// Moments of the observations of landmark `p` in the world, about the landmark's origin.
PointMoments WorldMoments(const LineObservations& observations, std::size_t p,
                          const LineLandmark& landmark, const std::vector<PoseFrame>& frames) {
  PointMoments moments;
  for (std::size_t i = observations.first_of_landmark[p]; i < observations.first_of_landmark[p + 1];
       ++i) {
    const LineObservation& observation = observations.observations[i];
    AddWorldMoments(observation, frames[observation.pose], landmark.origin, &moments);
  }
  return moments;
}

}  // namespace

double FitLandmarkLines(const LineObservations& observations, const std::vector<PoseFrame>& frames,
                        ThreadPool* pool, std::vector<LineLandmark>* landmarks) {
  std::vector<double> costs(ThreadPool::NumChunks(landmarks->size(), kLandmarksPerChunk), 0.0);
  pool->ForEachChunk(landmarks->size(), kLandmarksPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t p = begin; p < end; ++p) {
                         LineLandmark& landmark = (*landmarks)[p];
                         const PointMoments moments =
                             WorldMoments(observations, p, landmark, frames);
                         if (moments.weight <= 0.0) continue;
                         const LineFit fit = FitLine(moments);
                         landmark.normal = fit.normal;
                         landmark.offset_m = fit.normal.dot(fit.centroid);
                         costs[chunk] += 0.5 * moments.weight * fit.smaller_eigenvalue;
                       }
                     });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

double LandmarkLineCost(const LineObservations& observations, const std::vector<PoseFrame>& frames,
                        const std::vector<LineLandmark>& landmarks, ThreadPool* pool) {
  std::vector<double> costs(ThreadPool::NumChunks(landmarks.size(), kLandmarksPerChunk), 0.0);
  pool->ForEachChunk(landmarks.size(), kLandmarksPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t p = begin; p < end; ++p) {
                         const Eigen::Vector2d& n = landmarks[p].normal;
                         const double c = landmarks[p].offset_m;
                         const PointMoments m = WorldMoments(observations, p, landmarks[p], frames);
                         costs[chunk] +=
                             0.5 * (n.x() * n.x() * m.xx + 2.0 * n.x() * n.y() * m.xy +
                                    n.y() * n.y() * m.yy - 2.0 * c * (n.x() * m.x + n.y() * m.y) +
                                    c * c * m.weight);
                       }
                     });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

}  // namespace plumbline
