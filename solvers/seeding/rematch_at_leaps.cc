#include "plumbline/solvers/seeding/rematch_at_leaps.h"

#include <Eigen/Core>
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
// Poses before and after a leap that may hang behind, ...
constexpr int kPosesBefore = 8, kPosesAfter = 1;
// ... and those of them that hang behind so often that they are no good as a map.
constexpr int kPosesBeforeInMap = 2;
// A new pose must fit this much more of the scan than the old one, ...
constexpr double kMinGain = 0.05;
// ... and all but all of it, ...
constexpr double kMinInlierRatio = 0.8;
// ... or by this much more and at least half of it, if it makes the steps of the robot more even.
constexpr double kMinGainEven = 0.1;
constexpr double kMinInlierRatioEven = 0.5;
// Starts along a leap, at most.
constexpr int kMaxStarts = 8;
// Evenness is told by this many steps to either side.
constexpr int kStepsAround = 3;

// Per pose the first pose after the next leap, if it is at most so many poses before that leap or
// right after it; else 0. The first pose stays in any case: the drive begins there.
std::vector<int> FindLeaps(const std::vector<Pose2>& odometry, const MotionOptions& motion,
                           const std::vector<Pose2>& poses, int poses_before) {
  const int num_poses = static_cast<int>(poses.size());
  std::vector<int> leap_of_pose(poses.size(), 0);
  for (int p = num_poses - 1; p > 0; --p) {
    if (!IsLeap(odometry[p], Between(poses[p - 1], poses[p]), motion)) continue;
    const int begin = std::max(1, p - poses_before), end = std::min(num_poses, p + kPosesAfter + 1);
    std::fill(leap_of_pose.begin() + begin, leap_of_pose.begin() + end, p);
  }
  return leap_of_pose;
}

// Of the key scans around a pose.
LocalMap MapAround(int pose, const KeyGraph& keys, const std::vector<SurfacePoints>& surfaces,
                   const std::vector<int>& left_out, const std::vector<Pose2>& poses) {
  const auto after = std::partition_point(keys.key_scans.begin(), keys.key_scans.end(),
                                          [&](const KeyScan& key) { return key.pose <= pose; });
  const double path_m = after == keys.key_scans.begin() ? 0.0 : std::prev(after)->path_m;
  std::vector<const SurfacePoints*> scans;
  std::vector<Pose2> places;
  const auto first =
      std::partition_point(keys.key_scans.begin(), keys.key_scans.end(),
                           [&](const KeyScan& key) { return key.path_m < path_m - kMapPathM; });
  for (auto key = first; key != keys.key_scans.end() && key->path_m <= path_m + kMapPathM; ++key) {
    if (left_out[key->pose] != 0) continue;
    scans.push_back(&surfaces[key->scan]);
    places.push_back(poses[key->pose]);
  }
  LocalMap map(kMapCellM);
  map.Rebuild(scans, places);
  return map;
}

// What a leap adds to the odometry, in the world [m]; nothing at a broken edge, over which the
// robot was carried: no pose lies on the way.
Eigen::Vector2d LeapAt(int pose, const KeyGraph& keys, const std::vector<Pose2>& odometry,
                       const std::vector<Pose2>& poses) {
  const bool is_broken = std::any_of(
      keys.sequential.begin(), keys.sequential.end(),
      [pose](const SequentialEdge& edge) { return edge.broken && edge.first_pose_after == pose; });
  if (is_broken) return Eigen::Vector2d::Zero();
  return poses[pose].translation() - (poses[pose - 1] * odometry[pose]).translation();
}

// From the pose itself and from places on the way of the leap, which it may have made already.
ScanMatch BestMatch(const LocalMap& map, const SurfacePoints& scan, const Pose2& pose,
                    const Eigen::Vector2d& leap) {
  const ScanMatchOptions matching;
  const int num_starts =
      std::min(1 + static_cast<int>(std::ceil(leap.norm() / matching.coarse_gate_m)), kMaxStarts);
  ScanMatch best;
  for (int i = 0; i < num_starts; ++i) {
    const Eigen::Vector2d shift = leap * i / std::max(1, num_starts - 1);
    PosePrediction start;
    start.world_from_robot = Pose2(pose.x + shift.x(), pose.y + shift.y(), pose.yaw);
    const ScanMatch match = MatchScan(map, scan, start, matching);
    if (i == 0 || match.inlier_ratio > best.inlier_ratio) best = match;
  }
  return best;
}

// Sum of squares of what the steps around a pose differ from the odometry [m^2].
double Unevenness(int pose, const std::vector<Pose2>& odometry, const std::vector<Pose2>& poses) {
  const int num_poses = static_cast<int>(poses.size());
  double sum = 0.0;
  for (int p = std::max(1, pose - kStepsAround + 1); p <= pose + kStepsAround && p < num_poses;
       ++p) {
    const Pose2 off = Between(odometry[p], Between(poses[p - 1], poses[p]));
    sum += off.translation().squaredNorm();
  }
  return sum;
}

}  // namespace

void RematchAtLeaps(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                    const KeyGraph& keys, const std::vector<Pose2>& odometry,
                    const MotionOptions& motion, ThreadPool* pool,
                    std::vector<Pose2>* world_from_robot) {
  const std::vector<Pose2> before = *world_from_robot;
  const std::vector<int> leap_of_pose = FindLeaps(odometry, motion, before, kPosesBefore);
  const std::vector<int> not_in_map = FindLeaps(odometry, motion, before, kPosesBeforeInMap);
  const std::vector<int> scan_of_pose = MatchedScanOfPoses(graph, surfaces);
  std::vector<Pose2> after = before;
  std::vector<char> fits_well(before.size(), 0);
  pool->ForEachChunk(before.size(), 1, [&](std::size_t p, std::size_t, std::size_t) {
    const int pose = static_cast<int>(p), scan = scan_of_pose[pose];
    if (leap_of_pose[pose] == 0 || scan < 0) return;
    const LocalMap map = MapAround(pose, keys, surfaces, not_in_map, before);
    const ScanMatch old = MeasureFit(map, surfaces[scan], before[pose], ScanMatchOptions());
    const ScanMatch match = BestMatch(map, surfaces[scan], before[pose],
                                      LeapAt(leap_of_pose[pose], keys, odometry, before));
    const double gain = match.inlier_ratio - old.inlier_ratio;
    fits_well[p] = match.inlier_ratio >= kMinInlierRatio && gain >= kMinGain;
    if (fits_well[p] != 0 || (match.inlier_ratio >= kMinInlierRatioEven && gain >= kMinGainEven)) {
      after[p] = match.world_from_robot;
    }
  });
  for (std::size_t p = 0; p < before.size(); ++p) {
    const int pose = static_cast<int>(p);
    if (fits_well[p] != 0 ||
        Unevenness(pose, odometry, after) < Unevenness(pose, odometry, before)) {
      (*world_from_robot)[p] = after[p];
    }
  }
}

}  // namespace plumbline
