#include "plumbline/solvers/loop_closure/rematch_at_breaks.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "plumbline/solvers/front_end/free_space.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"

namespace plumbline {
namespace {

// All of this was tuned on the floors of the seeding study (apps/benchmark).
// Past this much path [m] beyond a break the sequential matching had a map of the new place.
constexpr double kSpoiltM = 2.0;
// The map is made of the sound keyframes of this much path [m] to either side.
constexpr double kBreakMapPathM = 8.0;
// Below this share of matched points the odometry alone says where the scan was.
constexpr double kMinBreakInlierRatio = 0.5;
// Where the sequential matching saw the break counts as this much of a scan.
constexpr double kTrustInFirstPose = 0.2;

struct Placed {
  Pose2 pose;
  double fit = 0.0;  // share of matched points, less what contradicts the keyframes around
};

// An edge at which the sequential matching went to another place, and the first keyframe beyond it
// that was matched soundly again.
struct Break {
  int edge;
  int sound;
};

// Whether the sequential matching went to another place, rather than be a little off.
bool IsMistakenBreak(const KeyframeGraph& keys, int edge) {
  constexpr double kFarM = 0.3, kFarRad = 0.15;
  const Pose2 off = Between(keys.sequential[edge].constraint.from_from_to,
                            Between(keys.world_from_key[edge], keys.world_from_key[edge + 1]));
  return std::hypot(off.x, off.y) > kFarM || std::abs(off.yaw) > kFarRad;
}

// The next break ends what the one before has spoilt.
int FirstSoundKey(const KeyframeGraph& keys, int edge) {
  int k = edge + 1;
  while (k + 1 < keys.size() && !keys.sequential[k].broken &&
         keys.keyframes[k].path_m - keys.keyframes[edge + 1].path_m < kSpoiltM) {
    ++k;
  }
  return k;
}

std::vector<Break> FindBreaks(const KeyframeGraph& keys) {
  std::vector<Break> breaks;
  for (int edge = 0; edge + 1 < keys.size(); ++edge) {
    const SequentialEdge& step = keys.sequential[edge];
    if (step.broken && !step.between_sessions && IsMistakenBreak(keys, edge)) {
      breaks.push_back({edge, FirstSoundKey(keys, edge)});
    }
  }
  return breaks;
}

// Of the poses that are matched anew.
std::vector<int> ScansAt(const std::vector<Break>& breaks, const KeyframeGraph& keys,
                         const ScanSurfaces& surfaces) {
  std::vector<int> scans;
  for (const auto& [edge, sound] : breaks) {
    for (int p = keys.keyframes[edge].pose + 1; p < keys.keyframes[sound].pose; ++p) {
      if (surfaces.scan_of_pose()[p] >= 0) scans.push_back(surfaces.scan_of_pose()[p]);
    }
  }
  return scans;
}

class Rematcher {
 public:
  Rematcher(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
            const std::vector<Break>& breaks, const std::vector<Pose2>& odometry,
            std::vector<Pose2>* world_from_robot)
      : surfaces_(surfaces),
        keys_(keys),
        odometry_(odometry),
        poses_(*world_from_robot),
        is_spoilt_(keys.keyframes.size(), false) {
    for (const auto& [edge, sound] : breaks) {
      std::fill(is_spoilt_.begin() + edge + 1, is_spoilt_.begin() + sound, true);
    }
  }

  void Rematch(const Break& here) {
    const auto [edge, sound] = here;
    BuildMap(edge, sound);
    witnesses_.clear();
    for (const int k : {SoundNeighbour(edge, -1), edge, sound, SoundNeighbour(sound, 1)}) {
      witnesses_.push_back(
          {surfaces_.FreeSpaceOf(keys_.keyframes[k].scan), keys_.world_from_key[k]});
    }
    const int begin = keys_.keyframes[edge].pose + 1;
    const int end = keys_.keyframes[edge + 1].pose;  // which lies beyond the break
    const int sound_pose = keys_.keyframes[sound].pose;
    // By the odometry from either side: forward[i] is pose begin + i, and so is backward[i].
    std::vector<Placed> forward, backward(std::max(0, sound_pose - begin));
    for (int p = begin; p < end; ++p) {
      forward.push_back(
          Match(p, (p == begin ? poses_[p - 1] : forward.back().pose) * odometry_[p]));
    }
    for (int p = sound_pose - 1; p >= begin; --p) {
      const Pose2 next = p + 1 == sound_pose ? poses_[p + 1] : backward[p + 1 - begin].pose;
      backward[p - begin] = Match(p, next * odometry_[p + 1].Inverse());
    }
    const int split = Split(edge, begin, forward, backward);
    for (int p = begin; p < sound_pose; ++p) {
      poses_[p] = (p < split ? forward : backward)[p - begin].pose;
    }
  }

 private:
  struct Witness {
    FreeSpaceScan free_space;
    Pose2 world_from_robot;
  };

  // The next keyframe in a direction that is not spoilt; at the end of the path the given one.
  int SoundNeighbour(int key, int direction) const {
    int k = key + direction;
    while (k >= 0 && k < keys_.size() && is_spoilt_[k]) k += direction;
    return k >= 0 && k < keys_.size() ? k : key;
  }

  void BuildMap(int edge, int sound) {
    std::vector<const PackedSurface*> points;
    std::vector<Pose2> poses;
    for (int k = 0; k < keys_.size(); ++k) {
      const int anchor = k <= edge ? edge : sound;
      const double path_m = std::abs(keys_.keyframes[k].path_m - keys_.keyframes[anchor].path_m);
      if (is_spoilt_[k] || path_m > kBreakMapPathM) continue;
      points.push_back(&surfaces_.Kept(keys_.keyframes[k].scan));
      poses.push_back(keys_.world_from_key[k]);
    }
    map_.Rebuild(points, poses);
  }

  Placed Match(int pose, const Pose2& predicted) const {
    const int scan = surfaces_.scan_of_pose()[pose];
    if (scan < 0) return {predicted, 0.0};
    PosePrediction start;
    start.world_from_robot = predicted;
    const ScanMatch match = MatchScan(map_, surfaces_.Of(scan), start, ScanMatchOptions());
    Placed placed{predicted, match.inlier_ratio};
    if (match.inlier_ratio >= kMinBreakInlierRatio) placed.pose = match.world_from_robot;
    const FreeSpaceScan free_space = surfaces_.FreeSpaceOf(scan);
    FreeSpaceConflict conflict;
    for (const Witness& witness : witnesses_) {
      conflict += CompareBothWays(witness.free_space, free_space,
                                  Between(witness.world_from_robot, placed.pose));
    }
    placed.fit -= conflict.Penalty();
    return placed;
  }

  // The first pose beyond the break, so that the scans fit best, each on its side.
  int Split(int edge, int begin, const std::vector<Placed>& forward,
            const std::vector<Placed>& backward) const {
    double fit = 0.0;
    for (const Placed& placed : backward) fit += placed.fit;
    int best = begin;
    double best_fit = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i <= forward.size(); ++i) {
      const int pose = begin + static_cast<int>(i);
      const double total =
          fit + (pose == keys_.sequential[edge].first_pose_after ? kTrustInFirstPose : 0.0);
      if (total > best_fit) {
        best_fit = total;
        best = pose;
      }
      if (i < forward.size()) fit += forward[i].fit - backward[i].fit;
    }
    return best;
  }

  const ScanSurfaces& surfaces_;
  const KeyframeGraph& keys_;
  const std::vector<Pose2>& odometry_;
  std::vector<Pose2>& poses_;
  LocalMap map_;
  std::vector<bool> is_spoilt_;     // per keyframe, by any break
  std::vector<Witness> witnesses_;  // the keyframes next to the break, on both sides
};

}  // namespace

void RematchAtBreaks(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                     const std::vector<Pose2>& odometry, std::vector<Pose2>* world_from_robot) {
  const std::vector<Break> breaks = FindBreaks(keys);
  if (breaks.empty()) return;
  const ScanSurfaces at_hand = surfaces.With(ScansAt(breaks, keys, surfaces));
  Rematcher rematcher(at_hand, keys, breaks, odometry, world_from_robot);
  for (const Break& here : breaks) rematcher.Rematch(here);
}

}  // namespace plumbline
