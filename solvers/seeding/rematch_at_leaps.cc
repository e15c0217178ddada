#include "plumbline/solvers/seeding/rematch_at_leaps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "plumbline/solvers/seeding/local_map.h"
#include "plumbline/solvers/seeding/odometry_noise.h"
#include "plumbline/solvers/seeding/scan_matcher.h"

namespace plumbline {
namespace {

constexpr double kMapCellM = 0.03;
// The map is made of the key scans of this much path [m] to either side.
constexpr double kMapPathM = 6.0;
// Poses before and after a leap that may hang behind.
constexpr int kPosesBefore = 2, kPosesAfter = 1;
// A new pose must fit this share of the scan, ...
constexpr double kMinInlierRatio = 0.8;
// ... and this much more than the old one.
constexpr double kMinGain = 0.05;

// Per pose whether it is next to a leap. The first one stays in any case: the drive begins there.
std::vector<char> NextToLeaps(const std::vector<Pose2>& odometry, const MotionOptions& motion,
                              const std::vector<Pose2>& poses) {
  const int num_poses = static_cast<int>(poses.size());
  std::vector<char> next_to_leap(poses.size(), 0);
  for (int p = 1; p < num_poses; ++p) {
    if (!IsLeap(odometry[p], Between(poses[p - 1], poses[p]), motion)) continue;
    const int begin = std::max(1, p - kPosesBefore), end = std::min(num_poses, p + kPosesAfter + 1);
    std::fill(next_to_leap.begin() + begin, next_to_leap.begin() + end, 1);
  }
  return next_to_leap;
}

// Of the key scans around a pose, but for those that are next to a leap themselves.
LocalMap MapAround(int pose, const KeyGraph& keys, const std::vector<SurfacePoints>& surfaces,
                   const std::vector<char>& next_to_leap, const std::vector<Pose2>& poses) {
  const auto after = std::partition_point(keys.key_scans.begin(), keys.key_scans.end(),
                                          [&](const KeyScan& key) { return key.pose <= pose; });
  const double path_m = after == keys.key_scans.begin() ? 0.0 : std::prev(after)->path_m;
  std::vector<const SurfacePoints*> scans;
  std::vector<Pose2> places;
  const auto first =
      std::partition_point(keys.key_scans.begin(), keys.key_scans.end(),
                           [&](const KeyScan& key) { return key.path_m < path_m - kMapPathM; });
  for (auto key = first; key != keys.key_scans.end() && key->path_m <= path_m + kMapPathM; ++key) {
    if (next_to_leap[key->pose] != 0) continue;
    scans.push_back(&surfaces[key->scan]);
    places.push_back(poses[key->pose]);
  }
  LocalMap map(kMapCellM);
  map.Rebuild(scans, places);
  return map;
}

}  // namespace

void RematchAtLeaps(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                    const KeyGraph& keys, const std::vector<Pose2>& odometry,
                    const MotionOptions& motion, ThreadPool* pool,
                    std::vector<Pose2>* world_from_robot) {
  const std::vector<Pose2> before = *world_from_robot;
  const std::vector<char> next_to_leap = NextToLeaps(odometry, motion, before);
  const std::vector<int> scan_of_pose = MatchedScanOfPoses(graph, surfaces);
  pool->ForEachChunk(before.size(), 1, [&](std::size_t p, std::size_t, std::size_t) {
    const int pose = static_cast<int>(p), scan = scan_of_pose[pose];
    if (next_to_leap[pose] == 0 || scan < 0) return;
    const LocalMap map = MapAround(pose, keys, surfaces, next_to_leap, before);
    const ScanMatchOptions matching;
    PosePrediction start;
    start.world_from_robot = before[pose];
    const ScanMatch match = MatchScan(map, surfaces[scan], start, matching);
    const ScanMatch old = MeasureFit(map, surfaces[scan], before[pose], matching);
    if (match.inlier_ratio >= std::max(kMinInlierRatio, old.inlier_ratio + kMinGain)) {
      (*world_from_robot)[pose] = match.world_from_robot;
    }
  });
}

}  // namespace plumbline
