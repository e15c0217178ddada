#include "plumbline/solvers/seeding/rematch_given_poses.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/interface/seeding_report.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/closure_memory.h"

namespace plumbline {
namespace {

constexpr int kMaxRematchRounds = 3;
// The map of a scan is made of the nearest keyframes within this distance [m], at most so many.
constexpr double kKeyframeReachM = 8.0;
constexpr std::size_t kMaxNearKeyframes = 40;
// A scan of which this share fits is not searched for, if it lies near its given pose.
constexpr double kFittingShare = 0.9;
// Half of the search window, in standard deviations of the given pose.
constexpr double kWindowSigmas = 4.0;
// A scan moves if chi-squared falls by this: odds of e^2 to 1.
constexpr double kMinFall = 4.0;
// Neighbouring points that count as one measurement of where the scan is. Tuned on
// intel-poor-poses.
constexpr double kPointsPerWitness = 3.0;
// The 95 % point of chi-squared with three degrees of freedom.
constexpr double kLikelyPull = 7.8;

struct MovedScan {
  int pose = 0;
  Pose2 world_from_robot;
};

class GivenPoseMatcher {
 public:
  // given_poses, world_from_robot: per pose.
  GivenPoseMatcher(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                   const std::vector<Pose2>& given_poses,
                   const std::vector<Pose2>& world_from_robot)
      : surfaces_(surfaces), keys_(keys), given_(given_poses), poses_(world_from_robot) {}

  // Where scan and given poses together are clearly more likely than where the scan is.
  std::optional<Pose2> FindBetter(int pose) const {
    const SurfacePoints scan = surfaces_.Of(surfaces_.scan_of_pose()[pose]);
    const Pose2 expected = keys_.given.world_from_given * given_[pose];
    const LocalMap map = MapAround(expected, pose);
    if (map.points().empty()) return std::nullopt;
    const ScanMatch as_it_is = MeasureFit(map, scan, poses_[pose], ScanMatchOptions());
    if (as_it_is.inlier_ratio >= kFittingShare && Pull(as_it_is, expected) <= kLikelyPull) {
      return std::nullopt;
    }
    const SearchWindow window{expected, kWindowSigmas * keys_.given.noise.position_m,
                              std::min(0.5 * kPi, kWindowSigmas * keys_.given.noise.yaw_rad)};
    double chi2 = Chi2(as_it_is, expected) - kMinFall;
    std::optional<Pose2> better;
    for (const ScanMatch& match : MatchInWindow(map, scan, window)) {
      if (Chi2(match, expected) >= chi2) continue;
      chi2 = Chi2(match, expected);
      better = match.world_from_robot;
    }
    return better;
  }

 private:
  // Of the given pose.
  double Pull(const ScanMatch& match, const Pose2& expected) const {
    const Pose2 off = Between(expected, match.world_from_robot);
    const double distance = off.translation().norm() / keys_.given.noise.position_m;
    const double turn = NormalizeAngle(off.yaw) / keys_.given.noise.yaw_rad;
    return distance * distance + turn * turn;
  }

  double Chi2(const ScanMatch& match, const Pose2& expected) const {
    return match.chi2 / kPointsPerWitness + Pull(match, expected);
  }

  LocalMap MapAround(const Pose2& center, int without_pose) const {
    std::vector<std::pair<double, const Keyframe*>> near;
    for (const Keyframe& key : keys_.keyframes) {
      const double distance_m = (poses_[key.pose].translation() - center.translation()).norm();
      if (key.pose != without_pose && distance_m <= kKeyframeReachM) {
        near.emplace_back(distance_m, &key);
      }
    }
    std::sort(near.begin(), near.end());
    if (near.size() > kMaxNearKeyframes) near.resize(kMaxNearKeyframes);
    std::vector<const PackedSurface*> scans;
    std::vector<Pose2> world_from_scan;
    for (const auto& [distance_m, key] : near) {
      scans.push_back(&surfaces_.Kept(key->scan));
      world_from_scan.push_back(poses_[key->pose]);
    }
    LocalMap map;
    map.Rebuild(scans, world_from_scan);
    return map;
  }

  const ScanSurfaces& surfaces_;
  const KeyframeGraph& keys_;
  const std::vector<Pose2>& given_;
  const std::vector<Pose2>& poses_;
};

std::vector<MovedScan> FindMoved(const ScanSurfaces& surfaces, const GivenPoseMatcher& matcher,
                                 ThreadPool* pool) {
  const SlamGraph& graph = surfaces.graph();
  std::vector<int> own;
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    if (surfaces.scan_of_pose()[pose] >= 0 && graph.HasScansOf(pose)) own.push_back(pose);
  }
  std::vector<std::optional<Pose2>> better(own.size());
  pool->ForEachChunk(own.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    better[i] = matcher.FindBetter(own[i]);
  });
  std::vector<MovedScan> moved;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (better[i]) moved.push_back({own[i], *better[i]});
  }
  return JoinOverPeers(graph.peers(), std::move(moved));
}

// Gives the steps to and from the moved scans their new values. world_from_robot: from which the
// scans moved.
void MoveScans(const std::vector<MovedScan>& moved, std::vector<Pose2> world_from_robot,
               SequentialTrajectory* trajectory) {
  std::vector<char> is_new(world_from_robot.size() + 1, 0);  // the step to each pose
  for (const MovedScan& scan : moved) {
    world_from_robot[scan.pose] = scan.world_from_robot;
    is_new[scan.pose] = is_new[scan.pose + 1] = 1;
  }
  const std::vector<Pose2> before = trajectory->world_from_robot;
  for (std::size_t p = 1; p < before.size(); ++p) {
    const std::vector<Pose2>& poses = is_new[p] != 0 ? world_from_robot : before;
    trajectory->world_from_robot[p] =
        trajectory->world_from_robot[p - 1] * Between(poses[p - 1], poses[p]);
  }
}

}  // namespace

Status RematchGivenPoses(const MotionOptions& motion, const ScanSurfaces& surfaces,
                         const SeedingProgress& progress, ThreadPool* pool,
                         SequentialTrajectory* trajectory) {
  for (int round = 0; round < kMaxRematchRounds; ++round) {
    KeyframeGraph keys = MakeKeyframeGraph(*trajectory, motion);
    ClosureMemory memory;
    LoopClosingReport loops;
    PLUMBLINE_RETURN_IF_ERROR(CloseLoops(surfaces, progress, pool, &memory, &keys, &loops));
    const std::vector<Pose2> poses = PosesFollowingKeyframes(keys, trajectory->world_from_robot);
    const GivenPoseMatcher matcher(surfaces, keys, trajectory->given_poses, poses);
    const std::vector<MovedScan> moved = FindMoved(surfaces, matcher, pool);
    if (moved.empty()) break;
    MoveScans(moved, poses, trajectory);
  }
  return Status::Ok();
}

}  // namespace plumbline
