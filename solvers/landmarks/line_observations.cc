#include "plumbline/solvers/landmarks/line_observations.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "plumbline/core/line_fit.h"
#include "plumbline/solvers/landmarks/return_residual.h"

namespace plumbline {
namespace {

constexpr std::size_t kPosesPerChunk = 64;

// Turns counts into the index of each group's first element; appends the end.
void CountsToOffsets(std::vector<std::size_t>* counts) {
  std::size_t sum = 0;
  for (std::size_t& count : *counts) sum += std::exchange(count, sum);
  counts->push_back(sum);
}

}  // namespace

std::vector<PoseFrame> FramesOf(const std::vector<double>& poses) {
  std::vector<PoseFrame> frames;
  frames.reserve(poses.size() / 3);
  for (std::size_t i = 0; i < poses.size(); i += 3) frames.emplace_back(&poses[i]);
  return frames;
}

ReturnCompressor::ReturnCompressor(const SlamGraph& graph, const SurfaceNoise& noise,
                                   ThreadPool* pool)
    : graph_(graph),
      noise_(noise),
      pool_(pool),
      scans_of_pose_(graph.num_scans()),
      first_scan_of_pose_(graph.num_poses(), 0) {
  for (int s = 0; s < graph.num_scans(); ++s) ++first_scan_of_pose_[graph.scan(s).pose];
  CountsToOffsets(&first_scan_of_pose_);
  std::iota(scans_of_pose_.begin(), scans_of_pose_.end(), 0);
  std::stable_sort(scans_of_pose_.begin(), scans_of_pose_.end(),
                   [&](int a, int b) { return graph.scan(a).pose < graph.scan(b).pose; });
}

template <typename Body>
void ReturnCompressor::ForEachReturnOnLandmark(std::size_t pose, const Body& body) {
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanEntry& scan = graph_.scan(scans_of_pose_[i]);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (entry_of_return_[r] != LineLandmarks::kNone) body(&entry_of_return_[r]);
    }
  }
}

std::vector<std::vector<int>> ReturnCompressor::ListLandmarks(
    std::vector<std::size_t>* first_of_pose) {
  const std::size_t num_poses = graph_.num_poses();
  std::vector<std::vector<int>> landmarks_of_chunk(
      ThreadPool::NumChunks(num_poses, kPosesPerChunk));
  first_of_pose->assign(num_poses, 0);
  pool_->ForEachChunk(
      num_poses, kPosesPerChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<int>& landmarks = landmarks_of_chunk[chunk];
        for (std::size_t pose = begin; pose < end; ++pose) {
          const std::size_t first = landmarks.size();
          ForEachReturnOnLandmark(pose, [&](const int* landmark) {
            if (landmarks.size() == first || landmarks.back() != *landmark)
              landmarks.push_back(*landmark);
          });
          std::sort(landmarks.begin() + first, landmarks.end());
          landmarks.erase(std::unique(landmarks.begin() + first, landmarks.end()), landmarks.end());
          (*first_of_pose)[pose] = landmarks.size() - first;
        }
      });
  CountsToOffsets(first_of_pose);
  return landmarks_of_chunk;
}

void ReturnCompressor::NameEntries(const std::vector<std::vector<int>>& landmarks_of_chunk,
                                   const LineObservations& observations) {
  landmark_of_entry_.resize(observations.of_pose.size());
  pool_->ForEachChunk(
      graph_.num_poses(), kPosesPerChunk,
      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        const std::vector<int>& landmarks = landmarks_of_chunk[chunk];
        const std::size_t start = observations.first_of_pose[begin];
        std::copy(landmarks.begin(), landmarks.end(), landmark_of_entry_.begin() + start);
        for (std::size_t pose = begin; pose < end; ++pose) {
          const auto first = landmark_of_entry_.begin() + observations.first_of_pose[pose];
          const auto last = landmark_of_entry_.begin() + observations.first_of_pose[pose + 1];
          int landmark = LineLandmarks::kNone, entry = LineLandmarks::kNone;
          ForEachReturnOnLandmark(pose, [&](int* of_return) {
            if (*of_return != landmark) {
              landmark = *of_return;
              entry = static_cast<int>(std::lower_bound(first, last, landmark) -
                                       landmark_of_entry_.begin());
            }
            *of_return = entry;
          });
        }
      });
}

LineObservations ReturnCompressor::LayOut(std::size_t num_landmarks,
                                          std::vector<int> landmark_of_return,
                                          SharedLandmarks shared) {
  entry_of_return_ = std::move(landmark_of_return);
  const std::size_t num_poses = graph_.num_poses();
  LineObservations result;
  const std::vector<std::vector<int>> landmarks_of_chunk = ListLandmarks(&result.first_of_pose);
  result.first_of_landmark.assign(num_landmarks, 0);
  for (const std::vector<int>& landmarks : landmarks_of_chunk) {
    for (const int landmark : landmarks) ++result.first_of_landmark[landmark];
  }
  CountsToOffsets(&result.first_of_landmark);
  result.observations.resize(result.first_of_pose.back());
  result.of_pose.resize(result.first_of_pose.back());
  std::vector<std::size_t> next = result.first_of_landmark;
  for (std::size_t pose = 0; pose < num_poses; ++pose) {
    const std::vector<int>& landmarks = landmarks_of_chunk[pose / kPosesPerChunk];
    const std::size_t start = result.first_of_pose[pose / kPosesPerChunk * kPosesPerChunk];
    for (std::size_t k = result.first_of_pose[pose]; k < result.first_of_pose[pose + 1]; ++k) {
      const int landmark = landmarks[k - start];
      result.of_pose[k] = static_cast<int>(next[landmark]);
      LineObservation& observation = result.observations[next[landmark]++];
      observation.pose = static_cast<int>(pose);
      observation.landmark = landmark;
    }
  }
  NameEntries(landmarks_of_chunk, result);
  result.shared = std::move(shared);
  return result;
}

std::vector<int> ReturnCompressor::TakeLandmarkOfReturn() {
  std::vector<int> landmarks = std::move(entry_of_return_);
  for (int& entry : landmarks) {
    if (entry != LineLandmarks::kNone) entry = landmark_of_entry_[entry];
  }
  ForgetLayout();
  return landmarks;
}

void ReturnCompressor::ForgetLayout() {
  entry_of_return_ = std::vector<int>();
  landmark_of_entry_ = std::vector<int>();
}

template <typename Body>
void ReturnCompressor::ForEachRun(std::size_t pose, const std::vector<LineLandmark>& landmarks,
                                  const PoseFrame& frame, const LineObservations& observations,
                                  const Body& body) const {
  const std::size_t first_entry = observations.first_of_pose[pose];
  std::vector<LineInRobot> lines;
  lines.reserve(observations.first_of_pose[pose + 1] - first_entry);
  for (std::size_t k = first_entry; k < observations.first_of_pose[pose + 1]; ++k) {
    lines.emplace_back(landmarks[landmark_of_entry_[k]], frame);
  }
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanEntry& scan = graph_.scan(scans_of_pose_[i]);
    const Eigen::Vector2d laser = graph_.laser(scan.laser).robot_from_laser.translation();
    const ScanReturns returns = graph_.ReturnsOfScan(scans_of_pose_[i]);
    const std::size_t end = scan.first_return + scan.num_returns;
    for (std::size_t begin = scan.first_return, after = begin; begin < end; begin = after) {
      const int entry = entry_of_return_[begin];
      for (++after; after < end && entry_of_return_[after] == entry;) ++after;
      if (entry == LineLandmarks::kNone) continue;
      const LineInRobot line = lines[entry - first_entry];
      body(entry - first_entry, [&, begin, after](const auto& take) {
        for (std::size_t r = begin; r < after; ++r) {
          take(ReturnResidual(returns.PointInRobot(r), laser, line, noise_));
        }
      });
    }
  }
}

template <typename Body>
double ReturnCompressor::SumOverPoses(const Body& cost_of_pose) const {
  const std::size_t num_poses = graph_.num_poses();
  std::vector<double> costs(ThreadPool::NumChunks(num_poses, kPosesPerChunk), 0.0);
  pool_->ForEachChunk(num_poses, kPosesPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        for (std::size_t pose = begin; pose < end; ++pose) {
                          costs[chunk] += cost_of_pose(pose);
                        }
                      });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

double ReturnCompressor::Weigh(const std::vector<LineLandmark>& landmarks,
                               const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                               LineObservations* observations) const {
  return SumOverPoses([&](std::size_t pose) {
    const std::size_t first = observations->first_of_pose[pose];
    // At hand, while the observations of a pose lie all over memory.
    std::vector<PointMoments> moments(observations->first_of_pose[pose + 1] - first);
    double cost = 0.0;
    ForEachRun(pose, landmarks, frames[pose], *observations,
               [&](std::size_t entry, const auto& for_each) {
                 PointMoments run;
                 for_each([&](const ReturnResidual& r) {
                   const RobustTerm term = loss.Term(r.distance, r.variance);
                   cost += 0.5 * term.rho;
                   run.Add(r.z.x(), r.z.y(), term.information);
                 });
                 moments[entry] += run;
               });
    for (std::size_t entry = 0; entry < moments.size(); ++entry) {
      SetMoments(moments[entry], &observations->observations[observations->of_pose[first + entry]]);
    }
    return cost;
  });
}

double ReturnCompressor::Cost(const std::vector<LineLandmark>& landmarks,
                              const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                              const LineObservations& observations) const {
  return SumOverPoses([&](std::size_t pose) {
    double cost = 0.0;
    ForEachRun(pose, landmarks, frames[pose], observations, [&](std::size_t, const auto& for_each) {
      for_each(
          [&](const ReturnResidual& r) { cost += 0.5 * loss.Term(r.distance, r.variance).rho; });
    });
    return cost;
  });
}

std::vector<RangeSlope> ReturnCompressor::RangeSlopes(const std::vector<LineLandmark>& landmarks,
                                                      const std::vector<PoseFrame>& frames,
                                                      const GemanMcClure& loss,
                                                      const LineObservations& observations) const {
  std::vector<RangeSlope> slopes(observations.observations.size());
  pool_->ForEachChunk(
      graph_.num_poses(), kPosesPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t pose = begin; pose < end; ++pose) {
          const int* observation_of_entry =
              observations.of_pose.data() + observations.first_of_pose[pose];
          ForEachRun(pose, landmarks, frames[pose], observations,
                     [&](std::size_t entry, const auto& for_each) {
                       RangeSlope& slope = slopes[observation_of_entry[entry]];
                       for_each([&](const ReturnResidual& r) {
                         const double weight = loss.Term(r.distance, r.variance).information;
                         const double cosine = r.normal.dot(r.beam.normalized());
                         slope.weight += weight * cosine;
                         slope.moment += weight * cosine * r.z;
                         slope.curvature += weight * cosine * cosine;
                         slope.gradient += weight * cosine * r.distance;
                       });
                     });
        }
      });
  return slopes;
}

}  // namespace plumbline
