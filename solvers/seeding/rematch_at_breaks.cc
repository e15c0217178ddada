#include "plumbline/solvers/seeding/rematch_at_breaks.h"

#include <Eigen/Core>
#include <cmath>

#include "plumbline/solvers/seeding/local_map.h"
#include "plumbline/solvers/seeding/scan_matcher.h"

namespace plumbline {
namespace {

constexpr double kMapCellM = 0.03;
// Past this much path [m] beyond a break the sequential matching had a map of the new place.
constexpr double kSpoiltM = 2.0;
// The map is made of the sound key scans of this much path [m] to either side.
constexpr double kMapPathM = 8.0;
// Below this share of matched points the odometry alone says where the scan was.
constexpr double kMinInlierRatio = 0.5;

class Rematcher {
 public:
  Rematcher(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
            const KeyGraph& keys, const std::vector<Pose2>& odometry,
            std::vector<Pose2>* world_from_robot)
      : surfaces_(surfaces),
        keys_(keys),
        odometry_(odometry),
        poses_(*world_from_robot),
        scan_of_pose_(MatchedScanOfPoses(graph, surfaces)) {}

  void Rematch(int edge) {
    const int sound = FirstSoundKey(edge);
    BuildMap(edge, sound);
    const int first_after = keys_.sequential[edge].first_pose_after;
    for (int p = keys_.key_scans[edge].pose + 1; p < first_after; ++p) {
      Match(p, poses_[p - 1] * odometry_[p]);
    }
    for (int p = keys_.key_scans[sound].pose - 1; p >= first_after; --p) {
      Match(p, poses_[p + 1] * odometry_[p + 1].Inverse());
    }
  }

 private:
  int FirstSoundKey(int edge) const {
    int k = edge + 1;
    while (k + 1 < keys_.size() && !keys_.sequential[k].broken &&
           keys_.key_scans[k].path_m - keys_.key_scans[edge + 1].path_m < kSpoiltM) {
      ++k;
    }
    return k;
  }

  void BuildMap(int edge, int sound) {
    std::vector<const SurfacePoints*> points;
    std::vector<Pose2> poses;
    for (int k = 0; k < keys_.size(); ++k) {
      const int anchor = k <= edge ? edge : sound;
      const double path_m = std::abs(keys_.key_scans[k].path_m - keys_.key_scans[anchor].path_m);
      if ((k > edge && k < sound) || path_m > kMapPathM) continue;
      points.push_back(&surfaces_[keys_.key_scans[k].scan]);
      poses.push_back(keys_.world_from_key[k]);
    }
    map_.Rebuild(points, poses);
  }

  void Match(int pose, const Pose2& predicted) {
    poses_[pose] = predicted;
    if (scan_of_pose_[pose] < 0) return;
    PosePrediction start;
    start.world_from_robot = predicted;
    const ScanMatch match =
        MatchScan(map_, surfaces_[scan_of_pose_[pose]], start, ScanMatchOptions());
    if (match.inlier_ratio >= kMinInlierRatio) poses_[pose] = match.world_from_robot;
  }

  const std::vector<SurfacePoints>& surfaces_;
  const KeyGraph& keys_;
  const std::vector<Pose2>& odometry_;
  std::vector<Pose2>& poses_;
  const std::vector<int> scan_of_pose_;
  LocalMap map_{kMapCellM};
};

}  // namespace

void RematchAtBreaks(const SlamGraph& graph, const std::vector<SurfacePoints>& surfaces,
                     const KeyGraph& keys, const std::vector<Pose2>& odometry,
                     std::vector<Pose2>* world_from_robot) {
  Rematcher rematcher(graph, surfaces, keys, odometry, world_from_robot);
  for (int edge = 0; edge + 1 < keys.size(); ++edge) {
    if (keys.sequential[edge].broken) rematcher.Rematch(edge);
  }
}

}  // namespace plumbline
