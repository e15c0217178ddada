#include "plumbline/solvers/landmarks/line_observations.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "plumbline/core/line_fit.h"
#include "plumbline/solvers/association/held_out_returns.h"
#include "plumbline/solvers/landmarks/return_residual.h"

namespace plumbline {
namespace {

// Few enough that a window of some hundred poses keeps all threads busy to the end.
constexpr std::size_t kPosesPerChunk = 16;
// The same goes for scans. More would save allocations of runs, and hardly any time.
constexpr std::size_t kScansPerArray = 16;

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
  const ReturnNormal* normals = selection.surface == nullptr
                                    ? nullptr
                                    : selection.surface->normals.data() + scan.first_return;
  // Up to the next one that is held out, or to the end.
  const int first_held_out = static_cast<int>(HeldOutReturns::FirstOf(graph_, scan_id));
  const int stride = static_cast<int>(HeldOutReturns::kOneIn);
  int held_out = selection.without_held_out ? first_held_out : num_returns;
  for (int begin = 0; begin < num_returns; begin = held_out + 1, held_out += stride) {
    const int end = std::min(held_out, num_returns);
    Run run{begin, begin, LineLandmarks::kNone};
    for (int i = begin; i < end; ++i) {
      const bool is_left_out = normals != nullptr && normals[i].IsNone();
      const int landmark = is_left_out ? LineLandmarks::kNone : landmarks[i];
      if (landmark == run.entry) continue;
      run.end = i;
      if (run.entry != LineLandmarks::kNone) body(run);
      run = {i, i, landmark};
    }
    run.end = end;
    if (run.entry != LineLandmarks::kNone) body(run);
  }
}

template <typename Body>
void ReturnCompressor::ForEachScanOf(std::size_t pose, const Body& body) const {
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    body(scans_of_pose_[i], runs_of_scan_[i]);
  }
}

void ReturnCompressor::ListRuns(const std::vector<int>& landmark_of_return,
                                const ReturnSelection& selection) {
  const std::size_t num_scans = scans_of_pose_.size();
  runs_of_chunk_.resize(ThreadPool::NumChunks(num_scans, kScansPerArray));
  runs_of_scan_.resize(num_scans);
  pool_->ForEachChunk(
      num_scans, kScansPerArray, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<Run> found;
        std::array<std::size_t, kScansPerArray + 1> first{};
        for (std::size_t i = begin; i < end; ++i) {
          FindRuns(scans_of_pose_[i], landmark_of_return, selection,
                   [&found](const Run& run) { found.push_back(run); });
          first[i - begin + 1] = found.size();
        }
        std::vector<Run>& runs = runs_of_chunk_[chunk];
        runs.assign(found.begin(), found.end());  // without room for more
        for (std::size_t i = begin; i < end; ++i) {
          runs_of_scan_[i] = {runs.data() + first[i - begin], runs.data() + first[i - begin + 1]};
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
          const std::size_t num_before = landmarks.size();
          ForEachScanOf(pose, [&](int, const RunsOfScan& runs) {
            for (const Run& run : runs) {
              const int seen_by = std::exchange(table[run.entry].last_pose, static_cast<int>(pose));
              if (seen_by != static_cast<int>(pose)) landmarks.push_back(run.entry);
            }
          });
          std::sort(landmarks.begin() + num_before, landmarks.end());
          first_entry_[pose] = landmarks.size() - num_before;
          for (std::size_t k = num_before; k < landmarks.size(); ++k) {
            table[landmarks[k]].entry = static_cast<int>(k - num_before);
          }
          ForEachScanOf(pose, [&](int, const RunsOfScan& runs) {
            for (Run& run : runs) run.entry = table[run.entry].entry;
          });
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
  runs_of_chunk_ = std::vector<std::vector<Run>>();
  runs_of_scan_ = std::vector<RunsOfScan>();
  landmark_of_entry_ = std::vector<int>();
  first_entry_ = std::vector<std::size_t>();
}

template <typename Body>
void ReturnCompressor::ForEachRun(std::size_t pose, const Body& body) const {
  ForEachScanOf(pose, [&](int scan_id, const RunsOfScan& runs) {
    const ScanReturns returns = graph_.ReturnsOfScan(scan_id);
    for (const Run& run : runs) body(scan_id, returns, run);
  });
}

template <typename Body>
void ReturnCompressor::ForEachResidual(std::size_t pose, const std::vector<LineLandmark>& landmarks,
                                       const PoseFrame& frame, Scratch* scratch,
                                       const Body& body) const {
  std::vector<LineInRobot>& lines = scratch->lines;
  lines.clear();
  for (std::size_t k = first_entry_[pose]; k < first_entry_[pose + 1]; ++k) {
    lines.emplace_back(landmarks[landmark_of_entry_[k]], frame);
  }
  ForEachRun(pose, [&](int scan_id, const ScanReturns& returns, const Run& run) {
    const std::size_t first_return = graph_.scan(scan_id).first_return;
    const LineInRobot line = lines[run.entry];
    body(run.entry, [&, first_return](const auto& take) {
      const std::size_t end = first_return + run.end;
      for (std::size_t r = first_return + run.first; r < end; r += 2) {
        const bool is_alone = r + 1 == end;
        take(ReturnPairResidual(returns, r, is_alone ? r : r + 1, line, noise_),
             Eigen::Array2d(1.0, is_alone ? 0.0 : 1.0));
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
                        Scratch scratch;
                        double cost = 0.0;
                        for (std::size_t pose = begin; pose < end; ++pose) {
                          cost += cost_of_pose(pose, &scratch);
                        }
                        costs[chunk] = cost;
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
  SumOverPoses([&](std::size_t pose, Scratch* scratch) {
    std::vector<PointMoments>& moments = scratch->moments;
    moments.assign(NumEntries(pose), PointMoments());
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
  return SumOverPoses([&](std::size_t pose, Scratch* scratch) {
    // At hand, while the observations of a pose lie all over memory.
    std::vector<PointMoments>& moments = scratch->moments;
    moments.assign(NumEntries(pose), PointMoments());
    Eigen::Array2d rho = Eigen::Array2d::Zero();
    ForEachResidual(pose, landmarks, frames[pose], scratch, [&](int entry, const auto& for_each) {
      Eigen::Array2d w = Eigen::Array2d::Zero(), x = w, y = w, xx = w, xy = w, yy = w;
      for_each([&](const ReturnPairResidual& r, const Eigen::Array2d& count) {
        const RobustTermOf<Eigen::Array2d> term = loss.Term(r.distance, r.variance);
        rho += count * term.rho;
        const Eigen::Array2d weight = count * term.information;
        const Eigen::Array2d wx = weight * r.x, wy = weight * r.y;
        w += weight;
        x += wx;
        y += wy;
        xx += wx * r.x;
        xy += wx * r.y;
        yy += wy * r.y;
      });
      moments[entry] += {w.sum(), x.sum(), y.sum(), xx.sum(), xy.sum(), yy.sum()};
    });
    SetObservations(pose, moments, observations);
    return 0.5 * rho.sum();
  });
}

double ReturnCompressor::Cost(const std::vector<LineLandmark>& landmarks,
                              const std::vector<PoseFrame>& frames,
                              const GemanMcClure& loss) const {
  return SumOverPoses([&](std::size_t pose, Scratch* scratch) {
    Eigen::Array2d rho = Eigen::Array2d::Zero();
    ForEachResidual(pose, landmarks, frames[pose], scratch, [&](int, const auto& for_each) {
      for_each([&](const ReturnPairResidual& r, const Eigen::Array2d& count) {
        rho += count * loss.Term(r.distance, r.variance).rho;
      });
    });
    return 0.5 * rho.sum();
  });
}

std::vector<RangeSlope> ReturnCompressor::RangeSlopes(const std::vector<LineLandmark>& landmarks,
                                                      const std::vector<PoseFrame>& frames,
                                                      const GemanMcClure& loss,
                                                      const LineObservations& observations) const {
  std::vector<RangeSlope> slopes(observations.observations.size());
  SumOverPoses([&](std::size_t pose, Scratch* scratch) {
    const int* of_pose = observations.of_pose.data() + observations.first_of_pose[pose];
    ForEachResidual(pose, landmarks, frames[pose], scratch, [&](int entry, const auto& for_each) {
      RangeSlope& slope = slopes[of_pose[entry]];
      for_each([&](const ReturnPairResidual& r, const Eigen::Array2d& count) {
        const Eigen::Array2d weighted =
            count * loss.Term(r.distance, r.variance).information * r.cosine;
        slope.weight += weighted.sum();
        slope.moment += Eigen::Vector2d((weighted * r.x).sum(), (weighted * r.y).sum());
        slope.curvature += (weighted * r.cosine).sum();
        slope.gradient += (weighted * r.distance).sum();
      });
    });
    return 0.0;
  });
  return slopes;
}

}  // namespace plumbline
