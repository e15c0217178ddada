#include "plumbline/solvers/seeding/sequential_seeding.h"

#include <Eigen/LU>
#include <cmath>
#include <cstddef>

#include "plumbline/core/options_check.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/seeding/local_map.h"
#include "plumbline/solvers/seeding/surface_points.h"

namespace plumbline {
namespace {

// The motion is taken as reversed (or as forward again) only if that explains the scan this much
// better than keeping the direction: where the scan cannot tell, the robot has not turned back.
constexpr double kReversalCostRatio = 0.9;
// Below this share of matched points a match is not trusted and the odometry stands.
constexpr double kMinInlierRatio = 0.25;

Pose2 ReversedTranslation(const Pose2& motion) { return {-motion.x, -motion.y, motion.yaw}; }

// The steps from each pose to the next one; fails where one is missing.
Status CollectSteps(const SlamGraph& graph, std::vector<int>* step_to_pose) {
  step_to_pose->assign(graph.num_poses(), -1);
  for (std::size_t i = 0; i < graph.odometry().size(); ++i) {
    const OdometryConstraint& step = graph.odometry()[i];
    if (step.to == step.from + 1) (*step_to_pose)[step.to] = static_cast<int>(i);
  }
  for (int pose = 1; pose < graph.num_poses(); ++pose) {
    if ((*step_to_pose)[pose] < 0) {
      return Status::InvalidArgument("seeding needs odometry from pose " +
                                     std::to_string(pose - 1) + " to pose " + std::to_string(pose) +
                                     ", but the graph has none");
    }
  }
  return Status::Ok();
}

class SequentialMatcher {
 public:
  SequentialMatcher(const SequentialSeedingOptions& options, const MotionOptions& motion,
                    bool sign_lost)
      : options_(options), motion_(motion), sign_lost_(sign_lost), map_(options.point_spacing_m) {}

  // Pose of the next scan, one odometry step after `previous`. Sets *motion to the step as driven.
  Pose2 Match(const Pose2& previous, const SurfacePoints& scan, Pose2* motion,
              SequentialSeedingReport* report) {
    if (sign_lost_ && reversing_) *motion = ReversedTranslation(*motion);
    ScanMatch match = MatchStep(previous, *motion, scan);
    if (sign_lost_ && motion->x != 0.0) {
      const Pose2 other_motion = ReversedTranslation(*motion);
      const ScanMatch other = MatchStep(previous, other_motion, scan);
      if (other.mean_cost < kReversalCostRatio * match.mean_cost) {
        match = other;
        *motion = other_motion;
        reversing_ = !reversing_;
      }
    }
    if (reversing_) ++report->num_reversed_steps;
    if (match.inlier_ratio >= kMinInlierRatio) return match.world_from_robot;
    ++report->num_unmatched;
    return previous * *motion;
  }

  // Adds the scan to the local map if the robot has moved on far enough. Returns whether it did.
  bool MaybeAddKeyScan(const Pose2& pose, const SurfacePoints& scan) {
    if (scan.empty()) return false;
    if (!key_poses_.empty()) {
      const Pose2 moved = Between(key_poses_.back(), pose);
      if (std::hypot(moved.x, moved.y) < options_.key_scan_distance_m &&
          std::abs(moved.yaw) < options_.key_scan_angle_rad) {
        return false;
      }
    }
    key_poses_.push_back(pose);
    key_scans_.push_back(&scan);
    if (static_cast<int>(key_poses_.size()) > options_.num_key_scans) {
      key_poses_.erase(key_poses_.begin());
      key_scans_.erase(key_scans_.begin());
    }
    map_.Rebuild(key_scans_, key_poses_);
    return true;
  }

 private:
  ScanMatch MatchStep(const Pose2& previous, const Pose2& motion, const SurfacePoints& scan) const {
    PosePrediction prediction;
    prediction.world_from_robot = previous * motion;
    // The motion's noise is given in the frame it starts from; the prediction wants its own.
    const double c = std::cos(motion.yaw), s = std::sin(motion.yaw);
    Eigen::Matrix3d from_from_to;
    from_from_to << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
    prediction.information =
        from_from_to.transpose() * MotionCovariance(motion, motion_).inverse() * from_from_to;
    return MatchScan(map_, scan, prediction, options_.matching);
  }

  const SequentialSeedingOptions& options_;
  const MotionOptions& motion_;
  const bool sign_lost_;
  bool reversing_ = false;
  LocalMap map_;
  std::vector<Pose2> key_poses_;
  std::vector<const SurfacePoints*> key_scans_;
};

}  // namespace

bool SequentialSeedingOptions::Check(std::string* error) const {
  std::string detail;
  if (!matching.Check(&detail)) {
    if (error != nullptr) *error = "matching." + detail;
    return false;
  }
  PLUMBLINE_CHECK_FINITE_OPTION(key_scan_distance_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(key_scan_angle_rad, >, 0.0);
  PLUMBLINE_CHECK_OPTION(num_key_scans, >, 0);
  PLUMBLINE_CHECK_FINITE_OPTION(point_spacing_m, >, 0.0);
  return true;
}

Status SeedSequentially(const SequentialSeedingOptions& options, const MotionOptions& motion,
                        const std::vector<Eigen::Vector2f>& normals,
                        const SeedingProgress& progress, ThreadPool* pool, SlamGraph* graph,
                        SequentialSeedingReport* report) {
  std::vector<int> step_to_pose;
  PLUMBLINE_RETURN_IF_ERROR(CollectSteps(*graph, &step_to_pose));
  const std::vector<SurfacePoints> surfaces =
      ThinnedSurfacePoints(*graph, normals, options.point_spacing_m, pool);
  *report = SequentialSeedingReport();
  report->odometry_sign = CheckOdometrySign(*graph, surfaces, pool);

  SequentialMatcher matcher(options, motion, report->odometry_sign.sign_lost);
  std::vector<Pose2> seeded(graph->num_poses());
  std::vector<Pose2> motions(graph->num_poses());
  std::vector<int> scan_of_pose(graph->num_poses(), -1);
  for (int s = graph->num_scans() - 1; s >= 0; --s) scan_of_pose[graph->scan(s).pose] = s;
  static const SurfacePoints kNoSurface;
  for (int pose = 0; pose < graph->num_poses(); ++pose) {
    const SurfacePoints& scan = scan_of_pose[pose] >= 0 ? surfaces[scan_of_pose[pose]] : kNoSurface;
    if (pose == 0) {
      seeded[0] = graph->WorldFromRobot(0);
    } else {
      motions[pose] = graph->odometry()[step_to_pose[pose]].from_from_to;
      seeded[pose] = matcher.Match(seeded[pose - 1], scan, &motions[pose], report);
    }
    if (matcher.MaybeAddKeyScan(seeded[pose], scan)) ++report->num_key_scans;
    constexpr int kPosesPerReport = 100;
    if (pose % kPosesPerReport == 0 && progress && !progress(pose, graph->num_poses())) {
      return Status::Unavailable("seeding was stopped by its caller");
    }
  }
  for (int pose = 0; pose < graph->num_poses(); ++pose) {
    graph->SetPose(pose, seeded[pose]);
    if (pose > 0) graph->SetOdometryMotion(step_to_pose[pose], motions[pose]);
  }
  graph->ResetPointsFromPoses();
  return Status::Ok();
}

}  // namespace plumbline
