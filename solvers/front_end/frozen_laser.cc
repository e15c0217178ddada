#include "plumbline/solvers/front_end/frozen_laser.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/core/angle.h"
#include "plumbline/core/copy_factor.h"
#include "plumbline/core/joined_returns.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

// Steps of wheels and gyros at rest: without this bound, the drift of a long rest would add up to a
// motion.
constexpr double kJitterM = 1e-3, kJitterRad = 1e-3;
// Least change of a reading [m]: the coarsest lasers round to 5 cm.
constexpr double kChangeM = 0.06;
// Fewer returns may repeat for another reason: parts of the robot, people who walk along.
constexpr int kMinReturns = 20;
// Fewer changes are expected of noise: the far end and the door frames of a bare corridor.
constexpr int kMinChanged = 10;
// Length [m] over which the direction of a surface is taken, and the sine of its error, about 20
// degrees even if ranges are rounded to 5 cm.
constexpr double kBaselineM = 0.25;
constexpr double kDirectionSine = 0.35;
// Largest motion that is judged as one: a long way along a corridor would hide a turn at its end.
constexpr double kLegM = 0.5, kLegRad = 0.5;

// Pose by odometry alone, jitter left out.
struct OdometryPose {
  Pose2 start_from_robot;
  int chain = 0;  // poses of different chains are not joined by odometry
  double path_m = 0.0, turns_rad = 0.0;
};

std::vector<OdometryPose> IntegrateOdometry(const SlamGraph& graph) {
  std::vector<const Pose2*> steps(graph.num_poses(), nullptr);
  for (const OdometryConstraint& constraint : graph.odometry()) {
    if (constraint.is_measured && constraint.to == constraint.from + 1)
      steps[constraint.to] = &constraint.from_from_to;
  }
  std::vector<OdometryPose> poses(graph.num_poses());
  for (int i = 1; i < graph.num_poses(); ++i) {
    poses[i] = poses[i - 1];
    if (steps[i] == nullptr) {
      ++poses[i].chain;
      continue;
    }
    const double length_m = steps[i]->translation().norm();
    const double turn_rad = std::abs(NormalizeAngle(steps[i]->yaw));
    if (length_m < kJitterM && turn_rad < kJitterRad) continue;
    poses[i].start_from_robot = poses[i - 1].start_from_robot * *steps[i];
    poses[i].path_m += length_m;
    poses[i].turns_rad += turn_rad;
  }
  return poses;
}

bool HaveSameReturns(const SlamGraph& graph, int scan_a, int scan_b) {
  const ScanEntry &a = graph.scan(scan_a), &b = graph.scan(scan_b);
  if (a.num_returns != b.num_returns) return false;
  const ScanReturns of_a = graph.ReturnsOfScan(scan_a), of_b = graph.ReturnsOfScan(scan_b);
  const std::vector<float>& ranges_m = graph.returns().range_m;
  for (std::size_t k = 0; k < a.num_returns; ++k) {
    const std::size_t r = a.first_return + k, s = b.first_return + k;
    if (ranges_m[r] != ranges_m[s] || of_a.Beam(r) != of_b.Beam(s) ||
        of_a.Bearing(r) != of_b.Bearing(s)) {
      return false;
    }
  }
  return true;
}

// Surfaces that a scan shows, to tell whether a motion would change it.
class ScanSurface {
 public:
  ScanSurface(const SlamGraph& graph, int scan) {
    MeasuredPoints(graph, scan, &points_);
    for (const Eigen::Vector2d& point : points_) reach_m_ = std::max(reach_m_, point.norm());
    directions_.assign(points_.size(), Eigen::Vector2d::Zero());
    std::size_t next = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      next = std::max(next, i + 1);
      while (next < points_.size() && (points_[next] - points_[i]).norm() < kBaselineM) ++next;
      if (next < points_.size()) directions_[i] = (points_[next] - points_[i]).normalized();
    }
  }

  // motion: of the robot, from where it took the scan.
  bool MustChange(const Pose2& motion) const {
    // No point moves further than this.
    const double most_m = motion.translation().norm() + reach_m_ * std::abs(motion.yaw);
    if (most_m < kChangeM) return false;
    int num_changed = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector2d shift = motion * points_[i] - points_[i];
      const Eigen::Vector2d& along = directions_[i];
      if (along.isZero()) continue;
      const double across_m = std::abs(along.x() * shift.y() - along.y() * shift.x());
      if (across_m > std::max(kChangeM, kDirectionSine * shift.norm())) ++num_changed;
    }
    return num_changed >= kMinChanged;
  }

 private:
  std::vector<Eigen::Vector2d> points_;      // in the frame of the robot
  std::vector<Eigen::Vector2d> directions_;  // of the surfaces; zero: not known
  double reach_m_ = 0.0;
};

// Whether the robot moved, between any two of these equal scans, in a way that changes them.
bool MovedAcross(const SlamGraph& graph, const std::vector<OdometryPose>& poses,
                 const std::vector<int>& scans) {
  const ScanSurface surface(graph, scans.front());
  const auto pose_of = [&](int scan) { return poses[graph.scan(scan).pose].start_from_robot; };
  Pose2 from = pose_of(scans.front());
  for (const int scan : scans) {
    const Pose2 to = pose_of(scan);
    const Pose2 motion = Between(from, to);
    if (surface.MustChange(motion)) return true;
    if (motion.translation().norm() > kLegM || std::abs(motion.yaw) > kLegRad) from = to;
  }
  return false;
}

}  // namespace

std::vector<FrozenStretch> FindFrozenStretches(const SlamGraph& graph) {
  const std::vector<OdometryPose> poses = IntegrateOdometry(graph);
  const auto pose_of = [&](int scan) -> const OdometryPose& {
    return poses[graph.scan(scan).pose];
  };
  std::vector<FrozenStretch> found;
  std::vector<std::vector<int>> equal_scans(graph.num_lasers());  // up to now
  const auto end_stretch = [&](std::vector<int>* scans) {
    if (scans->size() > 1 && graph.scan(scans->front()).num_returns >= kMinReturns &&
        MovedAcross(graph, poses, *scans)) {
      const OdometryPose &start = pose_of(scans->front()), &end = pose_of(scans->back());
      found.push_back({graph.scan(scans->front()).laser, scans->front(), scans->back(),
                       static_cast<int>(scans->size()) - 1, end.path_m - start.path_m,
                       end.turns_rad - start.turns_rad});
    }
    scans->clear();
  };
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    std::vector<int>& scans = equal_scans[graph.scan(scan).laser];
    const bool continues = !scans.empty() && pose_of(scans.back()).chain == pose_of(scan).chain &&
                           HaveSameReturns(graph, scans.back(), scan);
    if (!continues) end_stretch(&scans);
    scans.push_back(scan);
  }
  for (std::vector<int>& scans : equal_scans) end_stretch(&scans);
  std::sort(found.begin(), found.end(), [](const FrozenStretch& a, const FrozenStretch& b) {
    return a.last_scan < b.last_scan;
  });
  return found;
}

void DropRepeatedScans(SlamGraph* graph, std::vector<FrozenStretch>* frozen) {
  *frozen = FindFrozenStretches(*graph);
  if (frozen->empty()) return;
  std::vector<char> is_repeated(graph->num_scans(), 0);
  for (const FrozenStretch& stretch : *frozen) {
    for (int scan = stretch.first_scan + 1; scan <= stretch.last_scan; ++scan) {
      if (graph->scan(scan).laser == stretch.laser) is_repeated[scan] = 1;
    }
  }
  SlamGraph without;
  for (int laser = 0; laser < graph->num_lasers(); ++laser) {  // so that they keep their ids
    without.AddLaser(graph->laser(laser));
  }
  for (int pose = 0; pose < graph->num_poses(); ++pose) {
    without.AddPose(graph->InitialPose(pose), graph->timestamp_s(pose));
  }
  for (int scan = 0; scan < graph->num_scans(); ++scan) {
    if (is_repeated[scan] == 0) {
      without.AddScanOf(*graph, scan, graph->scan(scan).pose);
      continue;
    }
    const LaserModel& laser = graph->LaserOfScan(scan);
    const std::vector<double> no_return(laser.num_beams, laser.max_range_m);
    without.AddScan(graph->scan(scan).pose, graph->scan(scan).laser, no_return);
  }
  for (const OdometryConstraint& step : graph->odometry()) {
    without.AddOdometry(step);
  }
  for (const RelativePoseConstraint& constraint : graph->relative_poses()) {
    without.AddRelativePose(constraint);
  }
  const auto same = [](int pose) { return pose; };
  const auto kept = [&](int scan) { return is_repeated[scan] == 0 ? scan : -1; };
  for (const CustomFactor& factor : graph->factors()) {
    CopyFactor(*graph, factor, same, kept, &without);
  }
  if (graph->has_named_fixed_poses()) {
    for (const FixedPose& fixed : graph->fixed_poses()) {
      without.FixPose(fixed.pose, fixed.world_from_robot);
    }
  }
  *graph = std::move(without);
}

}  // namespace plumbline
