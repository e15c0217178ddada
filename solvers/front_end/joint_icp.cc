#include "plumbline/solvers/front_end/joint_icp.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "plumbline/core/float_environment.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"
#include "plumbline/solvers/pose_graph/pose_equations.h"
#include "plumbline/solvers/pose_graph/uncertain_edges.h"

namespace plumbline {
namespace {

// As fine as pairwise matching takes them.
constexpr double kScanCellM = 0.01;
constexpr int kMaxSteps = 20;
// Steps end when none of the poses moves by this much [m], its heading times kArmM counted in: a
// tenth of the accuracy of a scan match.
constexpr double kToleranceM = 3e-4;
constexpr double kArmM = 5.0;  // a usual distance of a return

// Of where a point lies by the pose of its robot; offset: from there, in world axes.
Eigen::Matrix<double, 2, 3> PointJacobian(const Eigen::Vector2d& offset) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << 1.0, 0.0, -offset.y(), 0.0, 1.0, offset.x();
  return jacobian;
}

class JointSystem {
 public:
  JointSystem(const PairwiseIcpOptions& options, const std::vector<SurfacePoints>& surfaces,
              const std::vector<PairOfScans>& pairs,
              const std::vector<RelativePoseConstraint>& links, ThreadPool* pool)
      : options_(options),
        surfaces_(surfaces),
        pairs_(pairs),
        links_(links),
        pool_(*pool),
        equations_(surfaces.size(), PairsOf(pairs, links)) {
    BuildMaps();
  }

  // Returns how far the pose moved that moved farthest [m]; a negative number if there is no step.
  double Step(std::vector<Pose2>* poses) {
    equations_.SetZero();
    AddPairs(*poses);
    for (std::size_t i = 0; i < links_.size(); ++i) AddLink(i, *poses);
    const Eigen::VectorXd step = equations_.Step(poses);
    double farthest_m = step.size() > 0 ? 0.0 : -1.0;
    for (Eigen::Index i = 0; i < step.size(); i += 3) {
      farthest_m = std::max(farthest_m, step.segment<2>(i).norm() + kArmM * std::abs(step[i + 2]));
    }
    return farthest_m;
  }

 private:
  // Pairs of scans, then links.
  static std::vector<std::pair<int, int>> PairsOf(
      const std::vector<PairOfScans>& pairs, const std::vector<RelativePoseConstraint>& links) {
    std::vector<std::pair<int, int>> all;
    all.reserve(pairs.size() + links.size());
    for (const PairOfScans& pair : pairs) all.emplace_back(pair.from, pair.to);
    for (const RelativePoseConstraint& link : links) all.emplace_back(link.from, link.to);
    return all;
  }

  void BuildMaps() {
    for (const PairOfScans& pair : pairs_) maps_.emplace(pair.from, LocalMap(kScanCellM));
    std::vector<std::pair<const int, LocalMap>*> all;
    for (auto& map : maps_) all.push_back(&map);
    pool_.ForEach(all.size(), 8, [&](std::size_t i) {
      const std::vector<const SurfacePoints*> scan = {&surfaces_[all[i]->first]};
      all[i]->second.Rebuild(scan, {Pose2()});
    });
  }

  void AddPairs(const std::vector<Pose2>& poses) {
    std::vector<PairEquations> of_pair(pairs_.size());
    pool_.ForEach(pairs_.size(), 16,
                  [&](std::size_t i) { of_pair[i] = EquationsOf(pairs_[i], poses); });
    for (std::size_t i = 0; i < pairs_.size(); ++i) equations_.Add(i, of_pair[i]);
  }

  PairEquations EquationsOf(const PairOfScans& pair, const std::vector<Pose2>& poses) const {
    const LocalMap& map = maps_.at(pair.from);
    const Pose2 from_from_to = Between(poses[pair.from], poses[pair.to]);
    const FrameChange to_from(from_from_to);
    const Eigen::Matrix2d world_from_from =
        Eigen::Rotation2Dd(poses[pair.from].yaw).toRotationMatrix();
    const Eigen::Vector2d to_robot = world_from_from * from_from_to.translation();
    const double gate_m = options_.fine_gate_m;
    const double weight = 1.0 / (kPointsPerError * options_.sigma_m * options_.sigma_m);
    PairEquations equations;
    for (const SurfacePoint& point : surfaces_[pair.to]) {
      const SurfacePoint in_from = to_from * point;
      const SurfacePoint* match = map.Nearest(in_from, gate_m);
      if (match == nullptr) continue;
      const Eigen::Vector2d position = world_from_from * match->position;
      const Eigen::Vector2d error = world_from_from * (in_from.position - match->position);
      const double tukey = 1.0 - error.squaredNorm() / (gate_m * gate_m);
      const Eigen::Matrix<double, 2, 3> d_from = -PointJacobian(position);
      const Eigen::Matrix<double, 2, 3> d_to = PointJacobian(position + error - to_robot);
      if (options_.metric == IcpMetric::kPointToPoint) {
        equations.Add(weight * tukey * tukey, d_from, d_to, error);
      } else {
        const Eigen::RowVector2d across = (world_from_from * match->normal).transpose();
        equations.Add(weight * tukey * tukey, Eigen::RowVector3d(across * d_from),
                      Eigen::RowVector3d(across * d_to), across.dot(error));
      }
    }
    return equations;
  }

  void AddLink(std::size_t i, const std::vector<Pose2>& poses) {
    const RelativePoseConstraint& link = links_[i];
    using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    RelativePoseResidual residual;
    residual.a_from_b = link.from_from_to;
    if (!SqrtInformation(link.covariance, &residual.sqrt_information)) return;
    const Pose2 &a = poses[link.from], &b = poses[link.to];
    const double from[] = {a.x, a.y, a.yaw}, to[] = {b.x, b.y, b.yaw};
    Eigen::Vector3d error;
    RowMajor3d d_from, d_to;
    residual.Evaluate(from, to, error.data(), d_from.data(), d_to.data());
    const double weight = 1.0 / (1.0 + error.squaredNorm() / (kCauchyScale * kCauchyScale));
    equations_.Add(pairs_.size() + i, weight, d_from, d_to, error);
  }

  const PairwiseIcpOptions& options_;
  const std::vector<SurfacePoints>& surfaces_;
  const std::vector<PairOfScans>& pairs_;
  const std::vector<RelativePoseConstraint>& links_;
  ThreadPool& pool_;
  std::map<int, LocalMap> maps_;  // of the scans that others are matched to
  PoseGraphEquations equations_;
};

}  // namespace

void AlignJointly(const PairwiseIcpOptions& options, const std::vector<SurfacePoints>& surfaces,
                  const std::vector<PairOfScans>& pairs,
                  const std::vector<RelativePoseConstraint>& links, ThreadPool* pool,
                  std::vector<Pose2>* world_from_pose) {
  if (world_from_pose->size() < 2) return;
  const DefaultFloatEnvironment float_environment;
  JointSystem system(options, surfaces, pairs, links, pool);
  std::vector<Pose2> poses = *world_from_pose;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double moved_m = system.Step(&poses);
    if (moved_m < 0.0) return;
    if (moved_m < kToleranceM) break;
  }
  *world_from_pose = std::move(poses);
}

}  // namespace plumbline
