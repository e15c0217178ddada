#include "plumbline/solvers/loop_closure/rematch_at_leaps.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/odometry_noise.h"
#include "plumbline/solvers/front_end/scan_matcher.h"

namespace plumbline {
namespace {

// All of this was tuned on the slips of the seeding study (apps/benchmark).
// The map is made of the keyframes of this much path [m] to either side.
constexpr double kLeapMapPathM = 6.0;
// Poses before and after a leap that may hang behind, ...
constexpr int kPosesBefore = 8, kPosesAfter = 1;
// ... and those of them that hang behind so often that they are no good as a map.
constexpr int kPosesBeforeInMap = 2;
// A new pose must fit at least half of the scan, and more than the old one. It is taken if it makes
// the steps of the robot more even, for then scan and odometry say the same; or if it fits so much
// more of the scan, and all but all of it or so many times as much as the old pose, as where the
// odometry took a scan that was not matched.
constexpr double kMinPartInlierRatio = 0.5;
constexpr double kMinGain = 0.05;
constexpr double kMinLeapInlierRatio = 0.8;
constexpr double kMinFactor = 2.0;

// Starts along a leap, at most, and how far they are turned from one to the next [rad], at least.
constexpr int kMaxStarts = 8;
constexpr double kStartTurnRad = 0.25;
// Evenness is told by this many steps to either side.
constexpr int kStepsAround = 3;

// The leaps of a trajectory, by the first pose after each.
class Leaps {
 public:
  Leaps(const KeyframeGraph& keys, const std::vector<Pose2>& odometry, const MotionOptions& motion,
        const std::vector<Pose2>& poses)
      : is_leap_(poses.size(), 0), is_carried_(poses.size(), 0) {
    for (std::size_t p = 1; p < poses.size(); ++p) {
      is_leap_[p] = IsLeap(odometry[p], Between(poses[p - 1], poses[p]), motion);
    }
    // Somewhere between the keyframes of a broken edge the robot was carried.
    for (const SequentialEdge& edge : keys.sequential) {
      if (!edge.broken) continue;
      const auto begin = is_carried_.begin();
      std::fill(begin + keys.keyframes[edge.constraint.from].pose + 1,
                begin + keys.keyframes[edge.constraint.to].pose + 1, 1);
    }
  }

  bool IsCarried(int pose) const { return is_carried_[pose] != 0; }

  // The next leap that is at most so many poses ahead, 0 if there is none.
  int Next(int pose, int most) const {
    const int end = std::min(static_cast<int>(is_leap_.size()), pose + most + 1);
    for (int p = pose + 1; p < end; ++p) {
      if (is_leap_[p] != 0) return p;
    }
    return 0;
  }

  // Whether the pose is at most so many poses before a leap, or right after it. The first one stays
  // in any case: the drive begins there.
  bool IsNear(int pose, int poses_before) const {
    if (pose == 0) return false;
    for (int p = pose; p >= 1 && p >= pose - kPosesAfter; --p) {
      if (is_leap_[p] != 0) return true;
    }
    return Next(pose, poses_before) != 0;
  }

 private:
  std::vector<char> is_leap_, is_carried_;
};

// Where a pose may be instead.
struct Rematch {
  int pose;
  Pose2 world_from_robot;
  bool fits_well;
};

// Of the other keyframes around a pose, but those that may well hang behind.
LocalMap MapAround(int pose, const KeyframeGraph& keys, const ScanSurfaces& surfaces,
                   const Leaps& leaps, const std::vector<Pose2>& poses) {
  const auto after = std::partition_point(keys.keyframes.begin(), keys.keyframes.end(),
                                          [&](const Keyframe& key) { return key.pose <= pose; });
  const double path_m = after == keys.keyframes.begin() ? 0.0 : std::prev(after)->path_m;
  std::vector<const PackedSurface*> scans;
  std::vector<Pose2> places;
  const auto first = std::partition_point(
      keys.keyframes.begin(), keys.keyframes.end(),
      [&](const Keyframe& key) { return key.path_m < path_m - kLeapMapPathM; });
  for (auto key = first; key != keys.keyframes.end() && key->path_m <= path_m + kLeapMapPathM;
       ++key) {
    if (key->pose == pose || leaps.IsNear(key->pose, kPosesBeforeInMap)) continue;
    scans.push_back(&surfaces.Kept(key->scan));
    places.push_back(poses[key->pose]);
  }
  LocalMap map;
  map.Rebuild(scans, places);
  return map;
}

// The pose as the odometry has it from beyond the next leap. The pose itself if there is none, or
// if the robot was carried over it: then no pose lies on the way.
Pose2 BeyondLeap(int pose, const Leaps& leaps, const std::vector<Pose2>& odometry,
                 const std::vector<Pose2>& poses) {
  const int next = leaps.Next(pose, kPosesBefore);
  if (next == 0 || leaps.IsCarried(next)) return poses[pose];
  const Pose2 leap = poses[next] * (poses[next - 1] * odometry[next]).Inverse();
  return leap * poses[pose];
}

// From the pose itself and from places on the way of the leap, which it may have made already.
ScanMatch BestMatch(const LocalMap& map, const SurfacePoints& scan, const Pose2& pose,
                    const Pose2& beyond) {
  const ScanMatchOptions matching;
  const Eigen::Vector2d leap = beyond.translation() - pose.translation();
  const double turn_rad = NormalizeAngle(beyond.yaw - pose.yaw);
  const double num_gates =
      std::max(leap.norm() / matching.coarse_gate_m, std::abs(turn_rad) / kStartTurnRad);
  const int num_starts = std::min(1 + static_cast<int>(std::ceil(num_gates)), kMaxStarts);
  ScanMatch best;
  for (int i = 0; i < num_starts; ++i) {
    const double share = static_cast<double>(i) / std::max(1, num_starts - 1);
    PosePrediction start;
    start.world_from_robot = Pose2(pose.x + share * leap.x(), pose.y + share * leap.y(),
                                   NormalizeAngle(pose.yaw + share * turn_rad));
    const ScanMatch match = MatchScan(map, scan, start, matching);
    if (i == 0 || match.inlier_ratio > best.inlier_ratio) best = match;
  }
  return best;
}

// Sum of squares of what the steps around a pose differ from the odometry [m^2], but for those over
// which the robot was carried.
double Unevenness(int pose, const Leaps& leaps, const std::vector<Pose2>& odometry,
                  const std::vector<Pose2>& poses) {
  const int num_poses = static_cast<int>(poses.size());
  double sum = 0.0;
  for (int p = std::max(1, pose - kStepsAround + 1); p <= pose + kStepsAround && p < num_poses;
       ++p) {
    if (leaps.IsCarried(p)) continue;
    const Pose2 off = Between(odometry[p], Between(poses[p - 1], poses[p]));
    sum += off.translation().squaredNorm();
  }
  return sum;
}

}  // namespace

void RematchAtLeaps(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                    const std::vector<Pose2>& odometry, const MotionOptions& motion,
                    ThreadPool* pool, std::vector<Pose2>* world_from_robot) {
  const std::vector<Pose2> before = *world_from_robot;
  const Leaps leaps(keys, odometry, motion, before);
  // Each process matches what it has the scans of.
  std::vector<int> poses;
  for (int pose = 0; pose < static_cast<int>(before.size()); ++pose) {
    if (leaps.IsNear(pose, kPosesBefore) && surfaces.scan_of_pose()[pose] >= 0 &&
        surfaces.graph().HasScansOf(pose)) {
      poses.push_back(pose);
    }
  }
  std::vector<Rematch> rematches(poses.size());
  pool->ForEachChunk(poses.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const int pose = poses[i], scan = surfaces.scan_of_pose()[pose];
    rematches[i] = {pose, before[pose], false};
    const LocalMap map = MapAround(pose, keys, surfaces, leaps, before);
    const SurfacePoints surface = surfaces.Of(scan);
    const ScanMatch old = MeasureFit(map, surface, before[pose], ScanMatchOptions());
    const ScanMatch match =
        BestMatch(map, surface, before[pose], BeyondLeap(pose, leaps, odometry, before));
    const double gain = match.inlier_ratio - old.inlier_ratio;
    if (match.inlier_ratio < kMinPartInlierRatio || gain <= 0.0) return;
    const bool fits_well =
        gain >= kMinGain && (match.inlier_ratio >= kMinLeapInlierRatio ||
                             match.inlier_ratio >= kMinFactor * old.inlier_ratio);
    rematches[i] = {pose, match.world_from_robot, fits_well};
  });
  std::vector<Pose2> after = before;
  std::vector<char> fits_well(before.size(), 0);
  for (const Rematch& rematch : JoinOverPeers(surfaces.graph().peers(), std::move(rematches))) {
    after[rematch.pose] = rematch.world_from_robot;
    fits_well[rematch.pose] = rematch.fits_well ? 1 : 0;
  }
  for (std::size_t p = 0; p < before.size(); ++p) {
    const int pose = static_cast<int>(p);
    if (fits_well[p] != 0 ||
        Unevenness(pose, leaps, odometry, after) < Unevenness(pose, leaps, odometry, before)) {
      (*world_from_robot)[p] = after[p];
    }
  }
}

}  // namespace plumbline
