#include "plumbline/solvers/landmarks/line_observations.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "plumbline/core/line_fit.h"
#include "plumbline/solvers/association/held_out_returns.h"
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
void ReturnCompressor::FindRuns(int scan_id, const std::vector<int>& landmark_of_return,
                                const ReturnSelection& selection, const Body& body) const {
  const ScanEntry& scan = graph_.scan(scan_id);
  const int num_returns = static_cast<int>(scan.num_returns);
  const int* landmarks = landmark_of_return.data() + scan.first_return;
  const std::size_t first_held_out = HeldOutReturns::FirstOf(graph_, scan_id);
  Run run{0, 0, LineLandmarks::kNone};
  for (int i = 0; i < num_returns; ++i) {
    const bool is_left_out =
        (selection.without_held_out && HeldOutReturns::Contain(i, first_held_out)) ||
        (selection.surface != nullptr &&
         selection.surface->normals[scan.first_return + i].IsNone());
    const int landmark = is_left_out ? LineLandmarks::kNone : landmarks[i];
    if (landmark == run.entry) continue;
    run.end = i;
    if (run.entry != LineLandmarks::kNone) body(run);
    run = {i, i, landmark};
  }
  run.end = num_returns;
  if (run.entry != LineLandmarks::kNone) body(run);
}

void ReturnCompressor::ListRuns(const std::vector<int>& landmark_of_return,
                                const ReturnSelection& selection) {
  // Counted first: arrays that grow would leave memory in pieces.
  first_run_.assign(scans_of_pose_.size(), 0);
  pool_->ForEachChunk(scans_of_pose_.size(), kPosesPerChunk,
                      [&](std::size_t, std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                          FindRuns(scans_of_pose_[i], landmark_of_return, selection,
                                   [&](const Run&) { ++first_run_[i]; });
                        }
                      });
  CountsToOffsets(&first_run_);
  runs_.resize(first_run_.back());
  pool_->ForEachChunk(scans_of_pose_.size(), kPosesPerChunk,
                      [&](std::size_t, std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                          Run* next = runs_.data() + first_run_[i];
                          FindRuns(scans_of_pose_[i], landmark_of_return, selection,
                                   [&](const Run& run) { *next++ = run; });
                        }
                      });
}

void ReturnCompressor::NumberEntries(std::size_t num_landmarks) {
  // Each chunk has a table of all landmarks: few chunks keep the work in proportion to the map.
  constexpr std::size_t kNumChunks = 64;
  const std::size_t num_poses = graph_.num_poses();
  const std::size_t poses_per_chunk = num_poses / kNumChunks + 1;
  std::vector<std::vector<int>> landmarks_of_chunk(
      ThreadPool::NumChunks(num_poses, poses_per_chunk));
  first_entry_.assign(num_poses, 0);
  pool_->ForEachChunk(
      num_poses, poses_per_chunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        struct Seen {
          int last_pose = -1;
          int entry = 0;
        };
        std::vector<Seen> table(num_landmarks);
        std::vector<int>& landmarks = landmarks_of_chunk[chunk];
        for (std::size_t pose = begin; pose < end; ++pose) {
          Run* const first = runs_.data() + first_run_[first_scan_of_pose_[pose]];
          Run* const last = runs_.data() + first_run_[first_scan_of_pose_[pose + 1]];
          const std::size_t num_before = landmarks.size();
          for (const Run* run = first; run != last; ++run) {
            const int seen_by = std::exchange(table[run->entry].last_pose, static_cast<int>(pose));
            if (seen_by != static_cast<int>(pose)) landmarks.push_back(run->entry);
          }
          std::sort(landmarks.begin() + num_before, landmarks.end());
          first_entry_[pose] = landmarks.size() - num_before;
          for (std::size_t k = num_before; k < landmarks.size(); ++k) {
            table[landmarks[k]].entry = static_cast<int>(k - num_before);
          }
          for (Run* run = first; run != last; ++run) run->entry = table[run->entry].entry;
        }
      });
  CountsToOffsets(&first_entry_);
  landmark_of_entry_.reserve(first_entry_.back());
  for (const std::vector<int>& landmarks : landmarks_of_chunk) {
    landmark_of_entry_.insert(landmark_of_entry_.end(), landmarks.begin(), landmarks.end());
  }
}

LineObservations ReturnCompressor::LayOut(std::size_t num_landmarks,
                                          const std::vector<int>& landmark_of_return,
                                          SharedLandmarks shared,
                                          const ReturnSelection& selection) {
  ForgetLayout();
  ListRuns(landmark_of_return, selection);
  NumberEntries(num_landmarks);
  LineObservations result;
  result.first_of_pose = first_entry_;
  result.first_of_landmark.assign(num_landmarks, 0);
  for (const int landmark : landmark_of_entry_) ++result.first_of_landmark[landmark];
  CountsToOffsets(&result.first_of_landmark);
  result.observations.resize(landmark_of_entry_.size());
  result.of_pose.resize(landmark_of_entry_.size());
  std::vector<std::size_t> next = result.first_of_landmark;
  for (std::size_t pose = 0; pose + 1 < first_entry_.size(); ++pose) {
    for (std::size_t k = first_entry_[pose]; k < first_entry_[pose + 1]; ++k) {
      const int landmark = landmark_of_entry_[k];
      result.of_pose[k] = static_cast<int>(next[landmark]);
      LineObservation& observation = result.observations[next[landmark]++];
      observation.pose = static_cast<int>(pose);
      observation.landmark = landmark;
    }
  }
  result.shared = std::move(shared);
  return result;
}

void ReturnCompressor::ForgetLayout() {
  runs_ = std::vector<Run>();
  first_run_ = std::vector<std::size_t>();
  landmark_of_entry_ = std::vector<int>();
  first_entry_ = std::vector<std::size_t>();
}

template <typename Body>
void ReturnCompressor::ForEachRun(std::size_t pose, const Body& body) const {
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanReturns returns = graph_.ReturnsOfScan(scans_of_pose_[i]);
    for (std::size_t run = first_run_[i]; run < first_run_[i + 1]; ++run) {
      body(scans_of_pose_[i], returns, runs_[run]);
    }
  }
}

template <typename Body>
void ReturnCompressor::ForEachResidual(std::size_t pose, const std::vector<LineLandmark>& landmarks,
                                       const PoseFrame& frame, const Body& body) const {
  std::vector<LineInRobot> lines;
  lines.reserve(NumEntries(pose));
  for (std::size_t k = first_entry_[pose]; k < first_entry_[pose + 1]; ++k) {
    lines.emplace_back(landmarks[landmark_of_entry_[k]], frame);
  }
  ForEachRun(pose, [&](int scan_id, const ScanReturns& returns, const Run& run) {
    const std::size_t first_return = graph_.scan(scan_id).first_return;
    const LineInRobot line = lines[run.entry];
    body(run.entry, [&, first_return](const auto& take) {
      for (std::size_t r = first_return + run.first; r < first_return + run.end; ++r) {
        take(ReturnResidual(returns, r, line, noise_));
      }
    });
  });
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

void ReturnCompressor::SetObservations(std::size_t pose, const std::vector<PointMoments>& moments,
                                       LineObservations* observations) const {
  const int* of_pose = observations->of_pose.data() + observations->first_of_pose[pose];
  for (std::size_t entry = 0; entry < moments.size(); ++entry) {
    SetMoments(moments[entry], &observations->observations[of_pose[entry]]);
  }
}

void ReturnCompressor::WeighEqually(LineObservations* observations) const {
  SumOverPoses([&](std::size_t pose) {
    std::vector<PointMoments> moments(NumEntries(pose));
    ForEachRun(pose, [&](int scan_id, const ScanReturns& returns, const Run& run) {
      const std::size_t first_return = graph_.scan(scan_id).first_return;
      PointMoments sum;
      for (std::size_t r = first_return + run.first; r < first_return + run.end; ++r) {
        const Eigen::Vector2d point = returns.PointInRobot(r);
        sum.Add(point.x(), point.y());
      }
      moments[run.entry] += sum;
    });
    SetObservations(pose, moments, observations);
    return 0.0;
  });
}

double ReturnCompressor::Weigh(const std::vector<LineLandmark>& landmarks,
                               const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                               LineObservations* observations) const {
  return SumOverPoses([&](std::size_t pose) {
    // At hand, while the observations of a pose lie all over memory.
    std::vector<PointMoments> moments(NumEntries(pose));
    double cost = 0.0;
    ForEachResidual(pose, landmarks, frames[pose], [&](int entry, const auto& for_each) {
      PointMoments run;
      for_each([&](const ReturnResidual& r) {
        const RobustTerm term = loss.Term(r.distance, r.variance);
        cost += 0.5 * term.rho;
        run.Add(r.z.x(), r.z.y(), term.information);
      });
      moments[entry] += run;
    });
    SetObservations(pose, moments, observations);
    return cost;
  });
}

double ReturnCompressor::Cost(const std::vector<LineLandmark>& landmarks,
                              const std::vector<PoseFrame>& frames,
                              const GemanMcClure& loss) const {
  return SumOverPoses([&](std::size_t pose) {
    double cost = 0.0;
    ForEachResidual(pose, landmarks, frames[pose], [&](int, const auto& for_each) {
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
  SumOverPoses([&](std::size_t pose) {
    const int* of_pose = observations.of_pose.data() + observations.first_of_pose[pose];
    ForEachResidual(pose, landmarks, frames[pose], [&](int entry, const auto& for_each) {
      RangeSlope& slope = slopes[of_pose[entry]];
      for_each([&](const ReturnResidual& r) {
        const double weight = loss.Term(r.distance, r.variance).information;
        slope.weight += weight * r.cosine;
        slope.moment += weight * r.cosine * r.z;
        slope.curvature += weight * r.cosine * r.cosine;
        slope.gradient += weight * r.cosine * r.distance;
      });
    });
    return 0.0;
  });
  return slopes;
}

}  // namespace plumbline
