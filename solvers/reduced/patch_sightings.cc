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
void ReturnCompressor::ForEachRun(std::size_t pose, const std::vector<SurfacePatch>& patches,
                                  const PoseFrame& frame, const PatchSightings& sightings,
                                  const Body& body) const {
  for (std::size_t i = first_scan_of_pose_[pose]; i < first_scan_of_pose_[pose + 1]; ++i) {
    const ScanEntry& scan = graph_.scan(scans_of_pose_[i]);
    const Eigen::Vector2d laser = graph_.laser(scan.laser).robot_from_laser.translation();
    const std::size_t end = scan.first_return + scan.num_returns;
    for (std::size_t begin = scan.first_return, after = begin; begin < end; begin = after) {
      const int sighting = sighting_of_return_[begin];
      for (++after; after < end && sighting_of_return_[after] == sighting;) ++after;
      if (sighting == SurfacePatches::kNone) continue;
      const LineInRobot line(patches[sightings.sightings[sighting].patch], frame);
      body(sighting, [&, begin, after](const auto& take) {
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
    for (std::size_t k = sightings->first_of_pose[pose]; k < sightings->first_of_pose[pose + 1];
         ++k) {
      PatchSighting& sighting = sightings->sightings[sightings->of_pose[k]];
      sighting.weight = sighting.xx = sighting.xy = sighting.yy = 0.0;
      sighting.centroid.setZero();
    }
    double cost = 0.0;
    ForEachRun(pose, patches, frames[pose], *sightings, [&](int index, const auto& for_each) {
      // Sums of a run are kept at hand; those of the sighting are in memory.
      PointMoments run;
      for_each([&](const Residual& r) {
        const RobustTerm term = loss.Term(r.distance, r.variance);
        cost += 0.5 * term.rho;
        run.Add(r.z.x(), r.z.y(), term.information);
      });
      PatchSighting& sighting = sightings->sightings[index];
      sighting.weight += run.weight;
      sighting.centroid += Eigen::Vector2d(run.x, run.y);
      sighting.xx += run.xx;
      sighting.xy += run.xy;
      sighting.yy += run.yy;
    });
    for (std::size_t k = sightings->first_of_pose[pose]; k < sightings->first_of_pose[pose + 1];
         ++k) {
      Center(&sightings->sightings[sightings->of_pose[k]]);
    }
    return cost;
  });
}

double ReturnCompressor::Cost(const std::vector<SurfacePatch>& patches,
                              const std::vector<PoseFrame>& frames, const GemanMcClure& loss,
                              const PatchSightings& sightings) const {
  return SumOverPoses([&](std::size_t pose) {
    double cost = 0.0;
    ForEachRun(pose, patches, frames[pose], sightings, [&](int, const auto& for_each) {
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
          ForEachRun(pose, patches, frames[pose], sightings, [&](int index, const auto& for_each) {
            RangeSlope& slope = slopes[index];
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
