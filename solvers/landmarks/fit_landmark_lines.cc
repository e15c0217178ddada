#include "plumbline/solvers/landmarks/fit_landmark_lines.h"

#include <cstddef>
#include <numeric>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/landmarks/world_moments.h"

namespace plumbline {

namespace {

constexpr std::size_t kLandmarksPerChunk = 64;

// Moments of the observations of landmarks in the world, about the landmark's origin; of all who
// share a landmark.
class WorldMomentsOfLandmarks {
 public:
  WorldMomentsOfLandmarks(const LineObservations& observations,
                          const std::vector<PoseFrame>& frames,
                          const std::vector<LineLandmark>& landmarks)
      : observations_(observations), frames_(frames), landmarks_(landmarks) {
    using Values = Eigen::Matrix<double, 6, 1>;
    const std::vector<Values> sums = observations.shared.Sum<6>([this](std::size_t p) -> Values {
      const PointMoments m = OwnMoments(p);
      return (Values() << m.weight, m.x, m.y, m.xx, m.xy, m.yy).finished();
    });
    shared_.reserve(sums.size());
    for (const Values& v : sums) shared_.push_back({v[0], v[1], v[2], v[3], v[4], v[5]});
  }

  PointMoments operator()(std::size_t p) const {
    const int slot = observations_.shared.SlotOf(p);
    return slot == SharedLandmarks::kNotShared ? OwnMoments(p) : shared_[slot];
  }

 private:
  PointMoments OwnMoments(std::size_t p) const {
    PointMoments moments;
    for (std::size_t i = observations_.first_of_landmark[p];
         i < observations_.first_of_landmark[p + 1]; ++i) {
      const LineObservation& observation = observations_.observations[i];
      AddWorldMoments(observation, frames_[observation.pose], landmarks_[p].origin, &moments);
    }
    return moments;
  }

  const LineObservations& observations_;
  const std::vector<PoseFrame>& frames_;
  const std::vector<LineLandmark>& landmarks_;
  std::vector<PointMoments> shared_;  // per slot
};

// The sum of cost_of(p) over all landmarks, of all processes.
template <typename Body>
double SumOverLandmarks(const LineObservations& observations, ThreadPool* pool,
                        const Body& cost_of) {
  const std::size_t num_landmarks = observations.num_landmarks();
  std::vector<double> costs(ThreadPool::NumChunks(num_landmarks, kLandmarksPerChunk), 0.0);
  pool->ForEachChunk(num_landmarks, kLandmarksPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       for (std::size_t p = begin; p < end; ++p) {
                         const double cost = cost_of(p);
                         if (observations.shared.IsCountedHere(p)) costs[chunk] += cost;
                       }
                     });
  return SumOverPeers(observations.shared.peers(),
                      std::accumulate(costs.begin(), costs.end(), 0.0));
}

}  // namespace

double FitLandmarkLines(const LineObservations& observations, const std::vector<PoseFrame>& frames,
                        ThreadPool* pool, std::vector<LineLandmark>* landmarks) {
  const WorldMomentsOfLandmarks moments_of(observations, frames, *landmarks);
  return SumOverLandmarks(observations, pool, [&](std::size_t p) {
    LineLandmark& landmark = (*landmarks)[p];
    const PointMoments moments = moments_of(p);
    if (moments.weight <= 0.0) return 0.0;
    const LineFit fit = FitLine(moments);
    landmark.normal = fit.normal;
    landmark.offset_m = fit.normal.dot(fit.centroid);
    return 0.5 * moments.weight * fit.smaller_eigenvalue;
  });
}

double LandmarkLineCost(const LineObservations& observations, const std::vector<PoseFrame>& frames,
                        const std::vector<LineLandmark>& landmarks, ThreadPool* pool) {
  const WorldMomentsOfLandmarks moments_of(observations, frames, landmarks);
  return SumOverLandmarks(observations, pool, [&](std::size_t p) {
    const Eigen::Vector2d& n = landmarks[p].normal;
    const double c = landmarks[p].offset_m;
    const PointMoments m = moments_of(p);
    return 0.5 * (n.x() * n.x() * m.xx + 2.0 * n.x() * n.y() * m.xy + n.y() * n.y() * m.yy -
                  2.0 * c * (n.x() * m.x + n.y() * m.y) + c * c * m.weight);
  });
}

}  // namespace plumbline
