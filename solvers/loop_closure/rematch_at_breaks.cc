#include "plumbline/solvers/loop_closure/rematch_at_breaks.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "plumbline/core/rotate_axes.h"
#include "plumbline/factors/motion_factor.h"
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
// The odometry errs this many times as much as usual, at most: wheels that slip err for a while,
// but along a corridor a scan fits everywhere.
constexpr double kOdometryNoiseFactor = 3.0;
// Where the sequential matching saw the break counts as this much of a scan.
constexpr double kTrustInFirstPose = 0.2;
// To be carried takes time: the longest pause on the edge counts as this much, if it is so many
// times as long as the others.
constexpr double kTrustInPause = 0.5;
constexpr double kPauseFactor = 3.0;

// A match that is off the odometry by this much of that noise [standard deviations] is as bad as
// none.
constexpr double kMostSigmasOff = 3.0;

struct Placed {
  Pose2 pose;
  // Share of matched points, less what contradicts the keyframes around, and the odometry.
  double fit = 0.0;
};

// An edge at which the sequential matching went to another place, and the keyframes next to it that
// were matched soundly: the last one before it and the first one beyond it. The keyframe right
// before the edge is not among them: it may have been the first one to go astray.
struct Break {
  int edge;
  int before;
  int beyond;
};

// Whether the sequential matching went to another place, rather than be a little off.
bool IsMistakenBreak(const KeyframeGraph& keys, int edge) {
  constexpr double kFarM = 0.3, kFarRad = 0.15;
  const Pose2 off = Between(keys.sequential[edge].constraint.from_from_to,
                            Between(keys.world_from_key[edge], keys.world_from_key[edge + 1]));
  return std::hypot(off.x, off.y) > kFarM || std::abs(off.yaw) > kFarRad;
}

// The next break ends what the one before has spoilt.
int SoundKeyBeyond(const KeyframeGraph& keys, int edge) {
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
      // What comes right after another break is nothing to fall back on.
      const bool may_be_astray = edge > (breaks.empty() ? 0 : breaks.back().beyond) &&
                                 !keys.sequential[edge - 1].between_sessions;
      breaks.push_back({edge, may_be_astray ? edge - 1 : edge, SoundKeyBeyond(keys, edge)});
    }
  }
  return breaks;
}

// Of the poses that are matched anew.
std::vector<int> ScansAt(const std::vector<Break>& breaks, const KeyframeGraph& keys,
                         const ScanSurfaces& surfaces) {
  std::vector<int> scans;
  for (const Break& here : breaks) {
    for (int p = keys.keyframes[here.before].pose + 1; p < keys.keyframes[here.beyond].pose; ++p) {
      if (surfaces.scan_of_pose()[p] >= 0) scans.push_back(surfaces.scan_of_pose()[p]);
    }
  }
  return scans;
}

class Rematcher {
 public:
  Rematcher(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
            const std::vector<Break>& breaks, const std::vector<Pose2>& odometry,
            const MotionOptions& motion, std::vector<Pose2>* world_from_robot)
      : surfaces_(surfaces),
        keys_(keys),
        odometry_(odometry),
        motion_(motion),
        poses_(*world_from_robot),
        is_spoilt_(keys.keyframes.size(), false) {
    for (const Break& here : breaks) {
      std::fill(is_spoilt_.begin() + here.before + 1, is_spoilt_.begin() + here.beyond, true);
    }
  }

  void Rematch(const Break& here) {
    const auto [edge, before, beyond] = here;
    BuildMap(here);
    witnesses_.clear();
    for (const int k : {SoundNeighbour(before, -1), before, beyond, SoundNeighbour(beyond, 1)}) {
      witnesses_.push_back(
          {surfaces_.FreeSpaceOf(keys_.keyframes[k].scan), keys_.world_from_key[k]});
    }
    const int begin = keys_.keyframes[before].pose + 1;
    const int end = keys_.keyframes[edge + 1].pose;  // which lies beyond the break
    const int sound_pose = keys_.keyframes[beyond].pose;
    // By the odometry from either side: forward[i] is pose begin + i, and so is backward[i].
    std::vector<Placed> forward, backward(std::max(0, sound_pose - begin));
    for (int p = begin; p < end; ++p) {
      const Pose2& previous = p == begin ? poses_[p - 1] : forward.back().pose;
      const Pose2& step = odometry_[p];
      forward.push_back(Match(p, {previous * step, RotateAxes(InformationOf(step), -step.yaw)}));
    }
    for (int p = sound_pose - 1; p >= begin; --p) {
      const Pose2& next = p + 1 == sound_pose ? poses_[p + 1] : backward[p + 1 - begin].pose;
      const Pose2& step = odometry_[p + 1];
      backward[p - begin] = Match(p, {next * step.Inverse(), InformationOf(step)});
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

  void BuildMap(const Break& here) {
    std::vector<const PackedSurface*> points;
    std::vector<Pose2> poses;
    for (int k = 0; k < keys_.size(); ++k) {
      const int anchor = k <= here.before ? here.before : here.beyond;
      const double path_m = std::abs(keys_.keyframes[k].path_m - keys_.keyframes[anchor].path_m);
      if (is_spoilt_[k] || path_m > kBreakMapPathM) continue;
      points.push_back(&surfaces_.Kept(keys_.keyframes[k].scan));
      poses.push_back(keys_.world_from_key[k]);
    }
    map_.Rebuild(points, poses);
  }

  // Of a step of the odometry, in the frame that it starts from.
  Eigen::Matrix3d InformationOf(const Pose2& step) const {
    constexpr double kVarianceFactor = kOdometryNoiseFactor * kOdometryNoiseFactor;
    return MotionCovariance(step, motion_).inverse() / kVarianceFactor;
  }

  Placed Match(int pose, const PosePrediction& predicted) const {
    const int scan = surfaces_.scan_of_pose()[pose];
    if (scan < 0) return {predicted.world_from_robot, 0.0};
    const SurfacePoints surface = surfaces_.Of(scan);
    const FreeSpaceScan free_space = surfaces_.FreeSpaceOf(scan);
    const ScanMatch match = MatchScan(map_, surface, predicted, ScanMatchOptions());
    Placed placed{predicted.world_from_robot, match.inlier_ratio};
    if (match.inlier_ratio >= kMinBreakInlierRatio) placed.pose = match.world_from_robot;
    placed.fit -= Contradiction(free_space, placed.pose) + Contradiction(predicted, placed.pose);
    return placed;
  }

  // By the odometry.
  static double Contradiction(const PosePrediction& predicted, const Pose2& world_from_robot) {
    const Pose2 off = Between(predicted.world_from_robot, world_from_robot);
    const Eigen::Vector3d error(off.x, off.y, off.yaw);
    const double chi2 = error.dot(predicted.information * error);
    return std::min(1.0, chi2 / (kMostSigmasOff * kMostSigmasOff));
  }

  // By the keyframes around.
  double Contradiction(const FreeSpaceScan& scan, const Pose2& world_from_robot) const {
    FreeSpaceConflict conflict;
    for (const Witness& witness : witnesses_) {
      conflict += CompareBothWays(witness.free_space, scan,
                                  Between(witness.world_from_robot, world_from_robot));
    }
    return conflict.Penalty();
  }

  // From `first` to `last`; -1 if there is none.
  int FirstPoseAfterPause(int first, int last) const {
    constexpr int kStepsAround = 2;
    const SlamGraph& graph = surfaces_.graph();
    const auto pause_s = [&](int p) { return graph.timestamp_s(p) - graph.timestamp_s(p - 1); };
    int longest = first;
    for (int p = first + 1; p <= last; ++p) {
      if (pause_s(p) > pause_s(longest)) longest = p;
    }
    double usual_s = 0.0;
    const int end = std::min(last + kStepsAround, graph.num_poses() - 1);
    for (int p = std::max(1, first - kStepsAround); p <= end; ++p) {
      if (p != longest) usual_s = std::max(usual_s, pause_s(p));
    }
    return pause_s(longest) > kPauseFactor * usual_s ? longest : -1;
  }

  // The first pose beyond the break, so that the scans fit best, each on its side.
  int Split(int edge, int begin, const std::vector<Placed>& forward,
            const std::vector<Placed>& backward) const {
    double fit = 0.0;
    for (const Placed& placed : backward) fit += placed.fit;
    const int after_pause = FirstPoseAfterPause(begin, begin + static_cast<int>(forward.size()));
    int best = begin;
    double best_fit = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i <= forward.size(); ++i) {
      const int pose = begin + static_cast<int>(i);
      const double total =
          fit + (pose == keys_.sequential[edge].first_pose_after ? kTrustInFirstPose : 0.0) +
          (pose == after_pause ? kTrustInPause : 0.0);
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
  const MotionOptions& motion_;
  std::vector<Pose2>& poses_;
  LocalMap map_;
  std::vector<bool> is_spoilt_;     // per keyframe, by any break
  std::vector<Witness> witnesses_;  // the keyframes next to the break, on both sides
};

}  // namespace

void RematchAtBreaks(const ScanSurfaces& surfaces, const KeyframeGraph& keys,
                     const std::vector<Pose2>& odometry, const MotionOptions& motion,
                     std::vector<Pose2>* world_from_robot) {
  const std::vector<Break> breaks = FindBreaks(keys);
  if (breaks.empty()) return;
  const ScanSurfaces at_hand = surfaces.With(ScansAt(breaks, keys, surfaces));
  Rematcher rematcher(at_hand, keys, breaks, odometry, motion, world_from_robot);
  for (const Break& here : breaks) rematcher.Rematch(here);
}

}  // namespace plumbline
