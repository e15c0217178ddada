#include "plumbline/solvers/seeding/seed.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <string>

#include "plumbline/core/options_check.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/seeding/loop_candidates.h"
#include "plumbline/solvers/seeding/match_covariance.h"
#include "plumbline/solvers/seeding/pose_graph.h"
#include "plumbline/solvers/seeding/surface_points.h"

namespace plumbline {
namespace {

// A closure that ends up five standard deviations off (three degrees of freedom, p = 1e-8) is
// wrong.
constexpr double kMaxClosureChi2 = 40.0;
// Rounds of looking for closures: each finds those that the one before has brought into reach.
constexpr int kNumRounds = 3;

// Covariance of the odometry from one pose to a later one, in the frame of the first.
Eigen::Matrix3d OdometryCovariance(const std::vector<Pose2>& odometry, int from, int to,
                                   const MotionOptions& options) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Pose2 from_from_pose;
  for (int pose = from + 1; pose <= to; ++pose) {
    const Eigen::Vector2d arm = Pose2(0.0, 0.0, from_from_pose.yaw) * odometry[pose].translation();
    Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
    carried(0, 2) = -arm.y();
    carried(1, 2) = arm.x();
    covariance = carried * covariance * carried.transpose() +
                 RotateAxes(MotionCovariance(odometry[pose], options), from_from_pose.yaw);
    from_from_pose = from_from_pose * odometry[pose];
  }
  return covariance;
}

// Edges from each key scan to the next one, as the sequential matching found them.
std::vector<RelativePoseConstraint> SequentialEdges(const SequentialTrajectory& trajectory,
                                                    const MotionOptions& motion) {
  std::vector<RelativePoseConstraint> edges;
  for (std::size_t k = 1; k < trajectory.key_scans.size(); ++k) {
    const KeyScan& from = trajectory.key_scans[k - 1];
    const KeyScan& to = trajectory.key_scans[k];
    const Pose2 from_from_to =
        Between(trajectory.world_from_robot[from.pose], trajectory.world_from_robot[to.pose]);
    const Eigen::Matrix3d known =
        OdometryCovariance(trajectory.odometry, from.pose, to.pose, motion).inverse();
    edges.push_back({static_cast<int>(k) - 1, static_cast<int>(k), from_from_to,
                     MatchCovariance(RotateAxes(to.information, from_from_to.yaw), known)});
  }
  return edges;
}

// Optimises, drops the closures that the others contradict, and optimises again.
int OptimizeAndPrune(const std::vector<RelativePoseConstraint>& sequential,
                     std::vector<RelativePoseConstraint>* closures,
                     std::vector<Pose2>* world_from_key) {
  OptimizePoseGraph(sequential, *closures, world_from_key);
  const auto wrong =
      std::remove_if(closures->begin(), closures->end(), [&](const RelativePoseConstraint& edge) {
        return EdgeChi2(edge, *world_from_key) > kMaxClosureChi2;
      });
  const int num_dropped = static_cast<int>(closures->end() - wrong);
  closures->erase(wrong, closures->end());
  if (num_dropped > 0) OptimizePoseGraph(sequential, *closures, world_from_key);
  return num_dropped;
}

std::vector<Pose2> PosesOfKeyScans(const SequentialTrajectory& trajectory) {
  std::vector<Pose2> poses;
  for (const KeyScan& key : trajectory.key_scans) {
    poses.push_back(trajectory.world_from_robot[key.pose]);
  }
  return poses;
}

// Carries every pose along with its key scans: as matched to the one before and to the one after,
// in the ratio of their distance in time.
void FollowKeyScans(const std::vector<Pose2>& world_from_key, SequentialTrajectory* trajectory) {
  const std::vector<KeyScan>& keys = trajectory->key_scans;
  if (keys.empty()) return;
  const std::vector<Pose2> before = trajectory->world_from_robot;
  std::size_t next = 0;
  for (int pose = 0; pose < static_cast<int>(before.size()); ++pose) {
    while (next < keys.size() && keys[next].pose <= pose) ++next;
    const std::size_t a = next > 0 ? next - 1 : 0;
    const std::size_t b = std::min(next, keys.size() - 1);
    const Pose2 from_a = world_from_key[a] * Between(before[keys[a].pose], before[pose]);
    const Pose2 from_b = world_from_key[b] * Between(before[keys[b].pose], before[pose]);
    const int span = keys[b].pose - keys[a].pose;
    const double share = span > 0 ? static_cast<double>(pose - keys[a].pose) / span : 0.0;
    const Pose2 a_from_b = Between(from_a, from_b);
    trajectory->world_from_robot[pose] =
        from_a * Pose2(share * a_from_b.x, share * a_from_b.y, share * a_from_b.yaw);
  }
}

void WriteTrajectory(const SequentialTrajectory& trajectory, SlamGraph* graph) {
  for (int pose = 0; pose < graph->num_poses(); ++pose) {
    graph->SetPose(pose, trajectory.world_from_robot[pose]);
  }
  for (std::size_t i = 0; i < graph->odometry().size(); ++i) {
    const OdometryConstraint& step = graph->odometry()[i];
    if (step.to == step.from + 1) graph->SetOdometryMotion(i, trajectory.odometry[step.to]);
  }
  graph->ResetPointsFromPoses();
}

}  // namespace

bool SeedingOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(point_spacing_m, >, 0.0);
  PLUMBLINE_CHECK_NESTED_OPTIONS(sequential);
  PLUMBLINE_CHECK_NESTED_OPTIONS(loops);
  return true;
}

Status SeedGraph(const SeedingOptions& options, const MotionOptions& motion,
                 const std::vector<Eigen::Vector2f>& normals, const SeedingProgress& progress,
                 ThreadPool* pool, SlamGraph* graph, SeedingReport* report) {
  std::string error;
  if (!options.Check(&error) || !motion.Check(&error)) return Status::InvalidArgument(error);
  if (normals.size() != graph->num_returns()) {
    return Status::InvalidArgument("seeding needs one normal per return, " +
                                   std::to_string(graph->num_returns()) + ", but got " +
                                   std::to_string(normals.size()));
  }
  const std::vector<SurfacePoints> surfaces =
      ThinnedSurfacePoints(*graph, normals, options.point_spacing_m, pool);
  SequentialTrajectory trajectory;
  PLUMBLINE_RETURN_IF_ERROR(SeedSequentially(options.sequential, motion, *graph, surfaces, progress,
                                             pool, &trajectory, &report->sequential));
  const std::vector<RelativePoseConstraint> sequential = SequentialEdges(trajectory, motion);
  std::vector<Pose2> world_from_key = PosesOfKeyScans(trajectory);
  std::vector<RelativePoseConstraint> closures;
  report->num_loop_candidates = report->num_dropped_closures = 0;
  for (int round = 0; round < kNumRounds; ++round) {
    const std::vector<LoopCandidate> candidates = FindLoopCandidates(
        options.loops.candidates, trajectory.key_scans, world_from_key, closures);
    const std::vector<RelativePoseConstraint> found = CloseLoops(
        options.loops, *graph, surfaces, trajectory.key_scans, world_from_key, candidates, pool);
    report->num_loop_candidates += static_cast<int>(candidates.size());
    closures.insert(closures.end(), found.begin(), found.end());
    report->num_dropped_closures += OptimizeAndPrune(sequential, &closures, &world_from_key);
    if (found.empty()) break;
  }
  report->num_closures = static_cast<int>(closures.size());
  FollowKeyScans(world_from_key, &trajectory);
  WriteTrajectory(trajectory, graph);
  return Status::Ok();
}

}  // namespace plumbline
