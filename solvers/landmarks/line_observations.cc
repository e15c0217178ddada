#include "plumbline/solvers/landmarks/line_observations.h"

#include <algorithm>
#include <cstdint>
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

// Numbers the landmarks of a pose, from 0 in the order in which they come.
class EntryNumbers {
 public:
  // Begins another pose, which calls NumberOf so often.
  void Clear(std::size_t num_calls) {
    log2_size_ = 1;
    while ((std::size_t{1} << log2_size_) < 2 * num_calls) ++log2_size_;
    slots_.assign(std::size_t{1} << log2_size_, Slot());
    num_entries_ = 0;
  }

  // Appends a landmark that is new.
  int NumberOf(int landmark, std::vector<int>* landmarks) {
    std::size_t at = (static_cast<std::uint32_t>(landmark) * 2654435769u) >> (32 - log2_size_);
    while (slots_[at].landmark != landmark) {
      if (slots_[at].landmark == LineLandmarks::kNone) {
        slots_[at] = {landmark, num_entries_++};
        landmarks->push_back(landmark);
        break;
      }
      at = (at + 1) & (slots_.size() - 1);
    }
    return slots_[at].number;
  }

 private:
  struct Slot {
    int landmark = LineLandmarks::kNone;
    int number = 0;
  };
  std::vector<Slot> slots_;
  int log2_size_ = 1;
  int num_entries_ = 0;
};

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

void ReturnCompressor::AddRunsOfScan(int scan_id, const std::vector<int>& landmark_of_return,
                                     const ReturnSelection& selection,
                                     std::vector<Run>* runs) const {
  const ScanEntry& scan = graph_.scan(scan_id);
  const int num_returns = static_cast<int>(scan.num_returns);
  const int* landmarks = landmark_of_return.data() + scan.first_return;
  int held_out = selection.without_held_out
                     ? static_cast<int>(HeldOutReturns::FirstOf(graph_, scan_id))
                     : num_returns;
  int landmark_before = LineLandmarks::kNone;
  for (int i = 0; i < num_returns; ++i) {
    int landmark = landmarks[i];
    if (i == held_out) {
      landmark = LineLandmarks::kNone;
      held_out += static_cast<int>(HeldOutReturns::kOneIn);
    } else if (selection.surface != nullptr &&
               selection.surface->normals[scan.first_return + i].IsNone()) {
      landmark = LineLandmarks::kNone;
    }
    if (landmark != LineLandmarks::kNone) {
      if (landmark != landmark_before) runs->push_back({i, i, landmark});
      runs->back().end = i + 1;
    }
    landmark_before = landmark;
  }
}

ReturnCompressor::Chunk ReturnCompressor::ListRuns(std::size_t begin, std::size_t end,
                                                   const std::vector<int>& landmark_of_return,
                                                   const ReturnSelection& selection) const {
  Chunk chunk;
  EntryNumbers numbers;
  for (std::size_t pose = begin; pose < end; ++pose) {
    const std::size_t first_run = chunk.runs.size();
    for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
      chunk.first_run.push_back(chunk.runs.size());
      AddRunsOfScan(scans_of_pose_[i], landmark_of_return, selection, &chunk.runs);
    }
    chunk.first_entry.push_back(chunk.landmarks.size());
    numbers.Clear(chunk.runs.size() - first_run);
    for (std::size_t run = first_run; run < chunk.runs.size(); ++run) {
      chunk.runs[run].entry = numbers.NumberOf(chunk.runs[run].entry, &chunk.landmarks);
    }
  }
  chunk.first_run.push_back(chunk.runs.size());
  chunk.first_entry.push_back(chunk.landmarks.size());
  chunk.runs.shrink_to_fit();
  chunk.landmarks.shrink_to_fit();
  return chunk;
}

LineObservations ReturnCompressor::LayOut(std::size_t num_landmarks,
                                          const std::vector<int>& landmark_of_return,
                                          SharedLandmarks shared,
                                          const ReturnSelection& selection) {
  chunks_.assign(ThreadPool::NumChunks(graph_.num_poses(), kPosesPerChunk), Chunk());
  pool_->ForEachChunk(graph_.num_poses(), kPosesPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        chunks_[chunk] = ListRuns(begin, end, landmark_of_return, selection);
                      });
  LineObservations result;
  result.first_of_landmark.assign(num_landmarks, 0);
  for (const Chunk& chunk : chunks_) {
    for (const int landmark : chunk.landmarks) ++result.first_of_landmark[landmark];
  }
  CountsToOffsets(&result.first_of_landmark);
  result.observations.resize(result.first_of_landmark.back());
  result.of_pose.reserve(result.observations.size());
  result.first_of_pose.reserve(graph_.num_poses() + 1);
  std::vector<std::size_t> next = result.first_of_landmark;
  int pose = 0;
  for (const Chunk& chunk : chunks_) {
    for (std::size_t p = 0; p + 1 < chunk.first_entry.size(); ++p, ++pose) {
      result.first_of_pose.push_back(result.of_pose.size());
      for (std::size_t entry = chunk.first_entry[p]; entry < chunk.first_entry[p + 1]; ++entry) {
        const int landmark = chunk.landmarks[entry];
        result.of_pose.push_back(static_cast<int>(next[landmark]));
        LineObservation& observation = result.observations[next[landmark]++];
        observation.pose = pose;
        observation.landmark = landmark;
      }
    }
  }
  result.first_of_pose.push_back(result.of_pose.size());
  result.shared = std::move(shared);
  return result;
}

template <typename Body>
void ReturnCompressor::ForEachRun(std::size_t pose, const Body& body) const {
  const Chunk& chunk = chunks_[pose / kPosesPerChunk];
  const std::size_t first_scan = first_scan_of_pose_[pose / kPosesPerChunk * kPosesPerChunk];
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanReturns returns = graph_.ReturnsOfScan(scans_of_pose_[i]);
    const std::size_t end = chunk.first_run[i - first_scan + 1];
    for (std::size_t run = chunk.first_run[i - first_scan]; run < end; ++run) {
      body(scans_of_pose_[i], returns, chunk.runs[run]);
    }
  }
}

template <typename Body>
void ReturnCompressor::ForEachResidual(std::size_t pose, const std::vector<LineLandmark>& landmarks,
                                       const PoseFrame& frame, const Body& body) const {
  const Chunk& chunk = chunks_[pose / kPosesPerChunk];
  std::vector<LineInRobot> lines;
  const std::size_t first = chunk.first_entry[pose % kPosesPerChunk];
  const std::size_t end = chunk.first_entry[pose % kPosesPerChunk + 1];
  lines.reserve(end - first);
  for (std::size_t k = first; k < end; ++k) {
    lines.emplace_back(landmarks[chunk.landmarks[k]], frame);
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
RobustCost ReturnCompressor::ForEachPose(const Body& body) const {
  std::vector<RobustCost> costs(chunks_.size());
  pool_->ForEachChunk(graph_.num_poses(), kPosesPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        for (std::size_t pose = begin; pose < end; ++pose)
                          body(pose, &costs[chunk]);
                      });
  RobustCost total;
  for (const RobustCost& cost : costs) {
    total.robust += cost.robust;
    total.weighted += cost.weighted;
  }
  return total;
}

void ReturnCompressor::SetObservations(std::size_t pose, const std::vector<PointMoments>& moments,
                                       LineObservations* observations) const {
  const int* of_pose = observations->of_pose.data() + observations->first_of_pose[pose];
  for (std::size_t entry = 0; entry < moments.size(); ++entry) {
    SetMoments(moments[entry], &observations->observations[of_pose[entry]]);
  }
}

std::size_t ReturnCompressor::NumEntries(std::size_t pose) const {
  const std::vector<std::size_t>& first = chunks_[pose / kPosesPerChunk].first_entry;
  return first[pose % kPosesPerChunk + 1] - first[pose % kPosesPerChunk];
}

void ReturnCompressor::WeighEqually(LineObservations* observations) const {
  ForEachPose([&](std::size_t pose, RobustCost* /*cost*/) {
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
  });
}

RobustCost ReturnCompressor::Weigh(const std::vector<LineLandmark>& landmarks,
                                   const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                                   LineObservations* observations) const {
  return ForEachPose([&](std::size_t pose, RobustCost* cost) {
    // At hand, while the observations of a pose lie all over memory.
    std::vector<PointMoments> moments(NumEntries(pose));
    double robust = 0.0, weighted = 0.0;
    ForEachResidual(pose, landmarks, frames[pose], [&](int entry, const auto& for_each) {
      PointMoments run;
      for_each([&](const ReturnResidual& r) {
        const RobustTerm term = loss.Term(r.distance, r.variance);
        robust += term.rho;
        weighted += term.information * r.distance * r.distance;
        run.Add(r.z.x(), r.z.y(), term.information);
      });
      moments[entry] += run;
    });
    SetObservations(pose, moments, observations);
    cost->robust += 0.5 * robust;
    cost->weighted += 0.5 * weighted;
  });
}

std::vector<RangeSlope> ReturnCompressor::RangeSlopes(const std::vector<LineLandmark>& landmarks,
                                                      const std::vector<PoseFrame>& frames,
                                                      const GemanMcClure& loss,
                                                      const LineObservations& observations) const {
  std::vector<RangeSlope> slopes(observations.observations.size());
  ForEachPose([&](std::size_t pose, RobustCost* /*cost*/) {
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
  });
  return slopes;
}

}  // namespace plumbline
