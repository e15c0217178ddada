#include "plumbline/solvers/reduced/patch_sightings.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace plumbline {
namespace {

constexpr std::size_t kPosesPerChunk = 64;

// Turns counts into the index of each group's first element; appends the end.
void CountsToOffsets(std::vector<std::size_t>* counts) {
  std::size_t sum = 0;
  for (std::size_t& count : *counts) sum += std::exchange(count, sum);
  counts->push_back(sum);
}

// Moments about the origin of the robot become moments about the centroid.
void Center(PatchSighting* sighting) {
  if (sighting->weight <= 0.0) return;
  sighting->centroid /= sighting->weight;
  const Eigen::Vector2d& m = sighting->centroid;
  sighting->xx = std::max(0.0, sighting->xx - sighting->weight * m.x() * m.x());
  sighting->xy -= sighting->weight * m.x() * m.y();
  sighting->yy = std::max(0.0, sighting->yy - sighting->weight * m.y() * m.y());
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
      if (sighting_of_return_[r] != SurfacePatches::kNone) body(&sighting_of_return_[r]);
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

void ReturnCompressor::NameSightings(const std::vector<std::vector<int>>& patches_of_chunk,
                                     const PatchSightings& sightings) {
  pool_->ForEachChunk(
      graph_.num_poses(), kPosesPerChunk,
      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        const std::vector<int>& patches = patches_of_chunk[chunk];
        const std::size_t start = sightings.first_of_pose[begin];
        for (std::size_t pose = begin; pose < end; ++pose) {
          const auto first = patches.begin() + (sightings.first_of_pose[pose] - start);
          const auto last = patches.begin() + (sightings.first_of_pose[pose + 1] - start);
          int patch = SurfacePatches::kNone, sighting = SurfacePatches::kNone;
          ForEachReturnOnPatch(pose, [&](int* of_return) {
            if (*of_return != patch) {
              patch = *of_return;
              sighting =
                  sightings
                      .of_pose[start + (std::lower_bound(first, last, patch) - patches.begin())];
            }
            *of_return = sighting;
          });
        }
      });
}

PatchSightings ReturnCompressor::LayOut(std::size_t num_patches, std::vector<int> patch_of_return) {
  sighting_of_return_ = std::move(patch_of_return);
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
  NameSightings(patches_of_chunk, result);
  return result;
}

std::vector<int> ReturnCompressor::PatchOfReturn(const PatchSightings& sightings) const {
  std::vector<int> patches = sighting_of_return_;
  for (int& entry : patches) {
    if (entry != SurfacePatches::kNone) entry = sightings.sightings[entry].patch;
  }
  return patches;
}

template <typename Body>
void ReturnCompressor::ForEachResidual(std::size_t pose, const std::vector<SurfacePatch>& patches,
                                       const PoseFrame& frame, const PatchSightings& sightings,
                                       const Body& body) const {
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanEntry& scan = graph_.scan(scans_of_pose_[i]);
    const Eigen::Vector2d laser = graph_.laser(scan.laser).robot_from_laser.translation();
    int current = SurfacePatches::kNone;
    LineInRobot line(SurfacePatch(), frame);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      if (sighting_of_return_[r] == SurfacePatches::kNone) continue;
      if (sighting_of_return_[r] != current) {
        current = sighting_of_return_[r];
        line = LineInRobot(patches[sightings.sightings[current].patch], frame);
      }
      Residual residual;
      residual.z = surface_.points[r].cast<double>();
      residual.beam = residual.z - laser;
      residual.normal = line.normal;
      residual.variance = noise_.surface_variance + noise_.BeamVariance(residual.beam, line.normal);
      residual.distance = line.normal.dot(residual.z) + line.offset;
      body(current, residual);
    }
  }
}

double ReturnCompressor::Weigh(const std::vector<SurfacePatch>& patches,
                               const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                               PatchSightings* sightings) const {
  const std::size_t num_poses = graph_.num_poses();
  std::vector<double> costs(ThreadPool::NumChunks(num_poses, kPosesPerChunk), 0.0);
  const auto weigh_pose = [&](std::size_t pose) {
    for (std::size_t k = sightings->first_of_pose[pose]; k < sightings->first_of_pose[pose + 1];
         ++k) {
      PatchSighting& sighting = sightings->sightings[sightings->of_pose[k]];
      sighting.weight = sighting.xx = sighting.xy = sighting.yy = 0.0;
      sighting.centroid.setZero();
    }
    double cost = 0.0;
    ForEachResidual(pose, patches, frames[pose], *sightings, [&](int index, const Residual& r) {
      const double squared = r.distance * r.distance / r.variance;
      const double weight = loss.Weight(squared) / r.variance;
      cost += 0.5 * loss.Rho(squared);
      PatchSighting& sighting = sightings->sightings[index];
      sighting.weight += weight;
      sighting.centroid += weight * r.z;
      sighting.xx += weight * r.z.x() * r.z.x();
      sighting.xy += weight * r.z.x() * r.z.y();
      sighting.yy += weight * r.z.y() * r.z.y();
    });
    for (std::size_t k = sightings->first_of_pose[pose]; k < sightings->first_of_pose[pose + 1];
         ++k) {
      Center(&sightings->sightings[sightings->of_pose[k]]);
    }
    return cost;
  };
  pool_->ForEachChunk(num_poses, kPosesPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        for (std::size_t pose = begin; pose < end; ++pose) {
                          costs[chunk] += weigh_pose(pose);
                        }
                      });
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

std::vector<RangeSlope> ReturnCompressor::RangeSlopes(const std::vector<SurfacePatch>& patches,
                                                      const std::vector<PoseFrame>& frames,
                                                      const GemanMcClure& loss,
                                                      const PatchSightings& sightings) const {
  std::vector<RangeSlope> slopes(sightings.sightings.size());
  pool_->ForEachChunk(
      graph_.num_poses(), kPosesPerChunk, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t pose = begin; pose < end; ++pose) {
          ForEachResidual(pose, patches, frames[pose], sightings,
                          [&](int index, const Residual& r) {
                            const double weight =
                                loss.Weight(r.distance * r.distance / r.variance) / r.variance;
                            const double slope = r.normal.dot(r.beam.normalized());
                            slopes[index].weight += weight * slope;
                            slopes[index].moment += weight * slope * r.z;
                            slopes[index].curvature += weight * slope * slope;
                            slopes[index].gradient += weight * slope * r.distance;
                          });
        }
      });
  return slopes;
}

}  // namespace plumbline
