#include "plumbline/solvers/reduced/patch_sightings.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "plumbline/core/line_fit.h"

namespace plumbline {
namespace {

constexpr std::size_t kPosesPerChunk = 64;

// Turns counts into the index of each group's first element; appends the end.
void CountsToOffsets(std::vector<std::size_t>* counts) {
  std::size_t sum = 0;
  for (std::size_t& count : *counts) sum += std::exchange(count, sum);
  counts->push_back(sum);
}

// From moments about the origin of the robot.
void SetMoments(const PointMoments& moments, PatchSighting* sighting) {
  sighting->weight = moments.weight;
  sighting->centroid = {moments.x, moments.y};
  if (moments.weight > 0.0) sighting->centroid /= moments.weight;
  const Eigen::Vector2d& m = sighting->centroid;
  sighting->xx = std::max(0.0, moments.xx - m.x() * moments.x);
  sighting->xy = moments.xy - m.x() * moments.y;
  sighting->yy = std::max(0.0, moments.yy - m.y() * moments.y);
}

// A patch's line in the frame of the robot: distance of z = normal . z + offset.
struct LineInRobot {
  Eigen::Vector2d normal;
  double offset;

  LineInRobot(const SurfacePatch& patch, const PoseFrame& frame) {
    normal = frame.RotateBack(patch.normal);
    offset = patch.normal.dot(frame.translation() - patch.origin) - patch.offset_m;
  }
};

// A return against the line of its patch, in the frame of its robot.
struct Residual {
  Eigen::Vector2d z, beam, normal;  // the return, seen from robot and laser [m]; of the line
  double distance, variance;        // from the line [m]; of that [m^2]

  Residual(const Eigen::Vector2d& in_robot, const Eigen::Vector2d& laser, const LineInRobot& line,
           const SurfaceNoise& noise)
      : z(in_robot),
        beam(in_robot - laser),
        normal(line.normal),
        distance(line.normal.dot(in_robot) + line.offset),
        variance(noise.surface_variance + noise.BeamVariance(beam, line.normal)) {}
};

}  // namespace

std::vector<PoseFrame> FramesOf(const std::vector<double>& poses) {
  std::vector<PoseFrame> frames;
  frames.reserve(poses.size() / 3);
  for (std::size_t i = 0; i < poses.size(); i += 3) frames.emplace_back(&poses[i]);
  return frames;
}

ReturnCompressor::ReturnCompressor(const SlamGraph& graph, const MeasuredSurface& surface,
                                   const SurfaceNoise& noise, ThreadPool* pool)
    : graph_(graph),
      surface_(surface),
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
void ReturnCompressor::ForEachReturnOnPatch(std::size_t pose, const Body& body) {
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanEntry& scan = graph_.scan(scans_of_pose_[i]);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (entry_of_return_[r] != SurfacePatches::kNone) body(&entry_of_return_[r]);
    }
  }
}

std::vector<std::vector<int>> ReturnCompressor::ListPatches(
    std::vector<std::size_t>* first_of_pose) {
  const std::size_t num_poses = graph_.num_poses();
  std::vector<std::vector<int>> patches_of_chunk(ThreadPool::NumChunks(num_poses, kPosesPerChunk));
  first_of_pose->assign(num_poses, 0);
  pool_->ForEachChunk(
      num_poses, kPosesPerChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        std::vector<int>& patches = patches_of_chunk[chunk];
        for (std::size_t pose = begin; pose < end; ++pose) {
          const std::size_t first = patches.size();
          ForEachReturnOnPatch(pose, [&](const int* patch) {
            if (patches.size() == first || patches.back() != *patch) patches.push_back(*patch);
          });
          std::sort(patches.begin() + first, patches.end());
          patches.erase(std::unique(patches.begin() + first, patches.end()), patches.end());
          (*first_of_pose)[pose] = patches.size() - first;
        }
      });
  CountsToOffsets(first_of_pose);
  return patches_of_chunk;
}

void ReturnCompressor::NameEntries(const std::vector<std::vector<int>>& patches_of_chunk,
                                   const PatchSightings& sightings) {
  patch_of_entry_.resize(sightings.of_pose.size());
  pool_->ForEachChunk(
      graph_.num_poses(), kPosesPerChunk,
      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        const std::vector<int>& patches = patches_of_chunk[chunk];
        const std::size_t start = sightings.first_of_pose[begin];
        std::copy(patches.begin(), patches.end(), patch_of_entry_.begin() + start);
        for (std::size_t pose = begin; pose < end; ++pose) {
          const auto first = patch_of_entry_.begin() + sightings.first_of_pose[pose];
          const auto last = patch_of_entry_.begin() + sightings.first_of_pose[pose + 1];
          int patch = SurfacePatches::kNone, entry = SurfacePatches::kNone;
          ForEachReturnOnPatch(pose, [&](int* of_return) {
            if (*of_return != patch) {
              patch = *of_return;
              entry =
                  static_cast<int>(std::lower_bound(first, last, patch) - patch_of_entry_.begin());
            }
            *of_return = entry;
          });
        }
      });
}

PatchSightings ReturnCompressor::LayOut(std::size_t num_patches, std::vector<int> patch_of_return) {
  entry_of_return_ = std::move(patch_of_return);
  const std::size_t num_poses = graph_.num_poses();
  PatchSightings result;
  const std::vector<std::vector<int>> patches_of_chunk = ListPatches(&result.first_of_pose);
  result.first_of_patch.assign(num_patches, 0);
  for (const std::vector<int>& patches : patches_of_chunk) {
    for (const int patch : patches) ++result.first_of_patch[patch];
  }
  CountsToOffsets(&result.first_of_patch);
  result.sightings.resize(result.first_of_pose.back());
  result.of_pose.resize(result.first_of_pose.back());
  std::vector<std::size_t> next = result.first_of_patch;
  for (std::size_t pose = 0; pose < num_poses; ++pose) {
    const std::vector<int>& patches = patches_of_chunk[pose / kPosesPerChunk];
    const std::size_t start = result.first_of_pose[pose / kPosesPerChunk * kPosesPerChunk];
    for (std::size_t k = result.first_of_pose[pose]; k < result.first_of_pose[pose + 1]; ++k) {
      const int patch = patches[k - start];
      result.of_pose[k] = static_cast<int>(next[patch]);
      PatchSighting& sighting = result.sightings[next[patch]++];
      sighting.pose = static_cast<int>(pose);
      sighting.patch = patch;
    }
  }
  NameEntries(patches_of_chunk, result);
  return result;
}

std::vector<int> ReturnCompressor::PatchOfReturn() const {
  std::vector<int> patches = entry_of_return_;
  for (int& entry : patches) {
    if (entry != SurfacePatches::kNone) entry = patch_of_entry_[entry];
  }
  return patches;
}

template <typename Body>
void ReturnCompressor::ForEachRun(std::size_t pose, const std::vector<SurfacePatch>& patches,
                                  const PoseFrame& frame, const PatchSightings& sightings,
                                  const Body& body) const {
  const std::size_t first_entry = sightings.first_of_pose[pose];
  std::vector<LineInRobot> lines;
  lines.reserve(sightings.first_of_pose[pose + 1] - first_entry);
  for (std::size_t k = first_entry; k < sightings.first_of_pose[pose + 1]; ++k) {
    lines.emplace_back(patches[patch_of_entry_[k]], frame);
  }
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanEntry& scan = graph_.scan(scans_of_pose_[i]);
    const Eigen::Vector2d laser = graph_.laser(scan.laser).robot_from_laser.translation();
    const std::size_t end = scan.first_return + scan.num_returns;
    for (std::size_t begin = scan.first_return, after = begin; begin < end; begin = after) {
      const int entry = entry_of_return_[begin];
      for (++after; after < end && entry_of_return_[after] == entry;) ++after;
      if (entry == SurfacePatches::kNone) continue;
      const LineInRobot line = lines[entry - first_entry];
      body(entry - first_entry, [&, begin, after](const auto& take) {
        for (std::size_t r = begin; r < after; ++r) {
          take(Residual(surface_.points[r].cast<double>(), laser, line, noise_));
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

double ReturnCompressor::Weigh(const std::vector<SurfacePatch>& patches,
                               const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                               PatchSightings* sightings) const {
  return SumOverPoses([&](std::size_t pose) {
    const std::size_t first = sightings->first_of_pose[pose];
    // At hand, while the sightings of a pose lie all over memory.
    std::vector<PointMoments> moments(sightings->first_of_pose[pose + 1] - first);
    double cost = 0.0;
    ForEachRun(pose, patches, frames[pose], *sightings,
               [&](std::size_t entry, const auto& for_each) {
                 PointMoments run;
                 for_each([&](const Residual& r) {
                   const RobustTerm term = loss.Term(r.distance, r.variance);
                   cost += 0.5 * term.rho;
                   run.Add(r.z.x(), r.z.y(), term.information);
                 });
                 moments[entry] += run;
               });
    for (std::size_t entry = 0; entry < moments.size(); ++entry) {
      SetMoments(moments[entry], &sightings->sightings[sightings->of_pose[first + entry]]);
    }
    return cost;
  });
}

double ReturnCompressor::Cost(const std::vector<SurfacePatch>& patches,
                              const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                              const PatchSightings& sightings) const {
  return SumOverPoses([&](std::size_t pose) {
    double cost = 0.0;
    ForEachRun(pose, patches, frames[pose], sightings, [&](std::size_t, const auto& for_each) {
      for_each([&](const Residual& r) { cost += 0.5 * loss.Term(r.distance, r.variance).rho; });
    });
    return cost;
  });
}

std::vector<RangeSlope> ReturnCompressor::RangeSlopes(const std::vector<SurfacePatch>& patches,
                                                      const std::vector<PoseFrame>& frames,
                                                      const GemanMcClure& loss,
                                                      const PatchSightings& sightings) const {
  std::vector<RangeSlope> slopes(sightings.sightings.size());
  pool_->ForEachChunk(
      graph_.num_poses(), kPosesPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t pose = begin; pose < end; ++pose) {
          const int* sighting_of_entry = sightings.of_pose.data() + sightings.first_of_pose[pose];
          ForEachRun(pose, patches, frames[pose], sightings,
                     [&](std::size_t entry, const auto& for_each) {
                       RangeSlope& slope = slopes[sighting_of_entry[entry]];
                       for_each([&](const Residual& r) {
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
