#include "plumbline/solvers/front_end/global_icp.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/float_environment.h"
#include "plumbline/core/options_check.h"
#include "plumbline/core/pose2.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/front_end/joint_icp.h"
#include "plumbline/solvers/front_end/scan_surfaces.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"
#include "plumbline/solvers/pose_graph/robust_pose_graph.h"

namespace plumbline {
namespace {

// A keyframe is this far from the one before it [m], or turned by this much [rad]: the two still
// see the same walls.
constexpr double kKeyframeM = 1.0;
constexpr double kKeyframeRad = 0.35;
// Rounds end when none of the keyframes moves by this much [m]: within what any match recovers.
constexpr double kSettledM = 0.02;
// Scans that overlap by less, but by this share of their points, say too little to close a loop,
// and still add to the accuracy of poses that others have found.
constexpr double kMinJointRatio = 0.2;
// Matches that are further off the optimum of all do not count: chi-squared with three degrees of
// freedom, which 99.9 % of the right ones stay below.
constexpr double kMaxChi2 = 16.3;

class GlobalIcp {
 public:
  GlobalIcp(const GlobalIcpOptions& options, const MotionOptions& motion,
            const MeasuredSurface& surface, ThreadPool* pool, const SlamGraph& graph,
            std::vector<Pose2> start)
      : options_(options),
        motion_(motion),
        pool_(*pool),
        start_(std::move(start)),
        surfaces_(start_.size()) {
    const ScanSurfaces scans(graph, surface);
    pool_.ForEach(start_.size(), 64, [&](std::size_t pose) {
      const int scan = scans.scan_of_pose()[pose];
      if (scan >= 0) surfaces_[pose] = scans.Of(scan);
    });
    ChooseKeyframes();
  }

  std::vector<Pose2> Align() {
    if (keyframes_.size() < 2) return start_;
    MatchConsecutive();
    for (int round = 0; round < options_.max_rounds; ++round) {
      const std::vector<Pose2> before = world_from_keyframe_;
      MatchNearby();
      OptimizeRobustly(chain_, closures_, &world_from_keyframe_);
      if (FarthestMove(before) < kSettledM) break;
    }
    std::vector<Pose2> poses = WithPosesBetween();
    AlignJointly(options_.icp, surfaces_, PairsThatAgree(), StepsOfStart(), &pool_, &poses);
    return poses;
  }

 private:
  int num_keyframes() const { return static_cast<int>(keyframes_.size()); }

  void ChooseKeyframes() {
    for (std::size_t pose = 0; pose < start_.size(); ++pose) {
      if (surfaces_[pose].empty()) continue;
      if (!keyframes_.empty()) {
        const Pose2 moved = Between(start_[keyframes_.back()], start_[pose]);
        if (moved.translation().norm() < kKeyframeM && std::abs(moved.yaw) < kKeyframeRad) continue;
      }
      keyframes_.push_back(static_cast<int>(pose));
      world_from_keyframe_.push_back(start_[pose]);
    }
  }

  const SurfacePoints& SurfaceOf(int keyframe) const { return surfaces_[keyframes_[keyframe]]; }

  // Where a match fails, the start stands.
  void MatchConsecutive() {
    chain_.resize(keyframes_.size() - 1);
    pool_.ForEach(chain_.size(), 8, [&](std::size_t i) {
      const int from = static_cast<int>(i), to = from + 1;
      const Pose2 guess = Between(world_from_keyframe_[from], world_from_keyframe_[to]);
      if (Match(from, to, &chain_[i]) < options_.min_inlier_ratio) {
        chain_[i] = {from, to, guess, MotionCovariance(guess, motion_)};
      }
    });
  }

  // The share of inliers; 0 if it did not converge.
  double Match(int from, int to, RelativePoseConstraint* edge) const {
    const Pose2 guess = Between(world_from_keyframe_[from], world_from_keyframe_[to]);
    const PairMatch match = MatchPair(SurfaceOf(from), SurfaceOf(to), guess, options_.icp);
    *edge = {from, to, match.from_from_to, match.covariance};
    return match.converged ? match.inlier_ratio : 0.0;
  }

  void MatchNearby() {
    std::vector<PairOfScans> pairs;
    for (int to = 2; to < num_keyframes(); ++to) AddPartners(to, &pairs);
    std::vector<RelativePoseConstraint> edges(pairs.size());
    std::vector<double> inlier_ratios(pairs.size(), 0);
    pool_.ForEach(pairs.size(), 8, [&](std::size_t i) {
      inlier_ratios[i] = Match(pairs[i].from, pairs[i].to, &edges[i]);
    });
    closures_.clear();
    small_overlaps_.clear();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (inlier_ratios[i] >= options_.min_inlier_ratio) {
        closures_.push_back(edges[i]);
      } else if (inlier_ratios[i] >= kMinJointRatio) {
        small_overlaps_.push_back(edges[i]);
      }
    }
  }

  // Matches with keyframes of one visit repeat each other. Where many earlier keyframes are near,
  // this takes some of them, spread over the drive.
  void AddPartners(int to, std::vector<PairOfScans>* pairs) const {
    std::vector<int> near;
    for (int from = 0; from + 1 < to; ++from) {
      const Pose2 guess = Between(world_from_keyframe_[from], world_from_keyframe_[to]);
      if (guess.translation().norm() <= options_.reach_m) near.push_back(from);
    }
    const std::size_t all = near.size();
    const std::size_t count = std::min<std::size_t>(all, options_.max_partners);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = count > 1 ? i * (all - 1) / (count - 1) : all - 1;
      pairs->push_back({near[k], to});
    }
  }

  double FarthestMove(const std::vector<Pose2>& before) const {
    double farthest = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Eigen::Vector2d move = world_from_keyframe_[i].translation() - before[i].translation();
      farthest = std::max(farthest, move.norm());
    }
    return farthest;
  }

  std::vector<Pose2> WithPosesBetween() const {
    std::vector<Pose2> poses = start_;
    for (int k = 0; k < num_keyframes(); ++k) {
      const int begin = keyframes_[k];
      const int end = k + 1 < num_keyframes() ? keyframes_[k + 1] : static_cast<int>(poses.size());
      for (int pose = begin; pose < end; ++pose) {
        poses[pose] = world_from_keyframe_[k] * Between(start_[begin], start_[pose]);
      }
    }
    return poses;
  }

  std::vector<PairOfScans> PairsThatAgree() const {
    std::vector<PairOfScans> pairs;
    const auto add = [&](const RelativePoseConstraint& edge) {
      if (EdgeChi2(edge, world_from_keyframe_) > kMaxChi2) return;
      pairs.push_back({keyframes_[edge.from], keyframes_[edge.to]});
    };
    std::for_each(chain_.begin(), chain_.end(), add);
    std::for_each(closures_.begin(), closures_.end(), add);
    std::for_each(small_overlaps_.begin(), small_overlaps_.end(), add);
    for (int k = 0, pose = 0; pose < static_cast<int>(start_.size()); ++pose) {
      if (k + 1 < num_keyframes() && pose == keyframes_[k + 1]) ++k;
      if (surfaces_[pose].empty() || pose == keyframes_[k]) continue;
      pairs.push_back({keyframes_[k], pose});
      if (k + 1 < num_keyframes()) pairs.push_back({keyframes_[k + 1], pose});
    }
    return pairs;
  }

  std::vector<RelativePoseConstraint> StepsOfStart() const {
    std::vector<RelativePoseConstraint> steps;
    for (int to = 1; to < static_cast<int>(start_.size()); ++to) {
      const Pose2 step = Between(start_[to - 1], start_[to]);
      steps.push_back({to - 1, to, step, MotionCovariance(step, motion_)});
    }
    return steps;
  }

  const GlobalIcpOptions& options_;
  const MotionOptions& motion_;
  ThreadPool& pool_;
  const std::vector<Pose2> start_;
  std::vector<SurfacePoints> surfaces_;  // per pose
  std::vector<int> keyframes_;           // their poses
  std::vector<Pose2> world_from_keyframe_;
  std::vector<RelativePoseConstraint> chain_, closures_, small_overlaps_;  // among keyframes
};

}  // namespace

bool GlobalIcpOptions::Check(std::string* error) const {
  if (!icp.Check(error)) return false;
  PLUMBLINE_CHECK_FINITE_OPTION(reach_m, >, 0.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(max_partners, 1, 1000);
  PLUMBLINE_CHECK_OPTION_WITHIN(min_inlier_ratio, 0.0, 1.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(max_rounds, 1, 1000);
  return true;
}

GlobalIcpOptions GlobalIcpOptionsFor(const RangeBeamOptions& beam, IcpMetric metric) {
  GlobalIcpOptions options;
  options.icp = IcpOptionsFor(beam, metric);
  return options;
}

Status AlignScansGlobally(const GlobalIcpOptions& options, const MotionOptions& motion,
                          const MeasuredSurface& surface, ThreadPool* pool, const SlamGraph& graph,
                          MapState* state) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  if (surface.normals.size() != graph.num_returns()) {
    return Status::InvalidArgument("global ICP needs one normal per return, " +
                                   std::to_string(graph.num_returns()) + ", but got " +
                                   std::to_string(surface.normals.size()));
  }
  if (state->poses.size() != 3 * static_cast<std::size_t>(graph.num_poses())) {
    return Status::InvalidArgument("global ICP needs a start for each of " +
                                   std::to_string(graph.num_poses()) + " poses, but got " +
                                   std::to_string(state->poses.size() / 3));
  }
  const DefaultFloatEnvironment float_environment;
  GlobalIcp icp(options, motion, surface, pool, graph, PosesOf(state->poses));
  state->poses = PoseArray(icp.Align());
  state->points = graph.MeasuredMap(state->poses);
  return Status::Ok();
}

}  // namespace plumbline
