#include "plumbline/solvers/seeding/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"

namespace plumbline {
namespace {

// Closures bend away from three standard deviations on.
constexpr double kCauchyScale = 3.0;
constexpr int kMaxIterations = 50;

using Block = std::array<double, 3>;

// False on a covariance that is not positive definite.
bool MakeResidual(const RelativePoseConstraint& edge, RelativePoseResidual* residual) {
  residual->a_from_b = edge.from_from_to;
  return SqrtInformation(edge.covariance, &residual->sqrt_information);
}

void AddEdges(const std::vector<RelativePoseConstraint>& edges, ceres::LossFunction* loss,
              std::vector<Block>* blocks, ceres::Problem* problem) {
  for (const RelativePoseConstraint& edge : edges) {
    RelativePoseResidual residual;
    if (!MakeResidual(edge, &residual)) continue;
    problem->AddResidualBlock(new RelativePoseFactor(residual), loss, (*blocks)[edge.from].data(),
                              (*blocks)[edge.to].data());
  }
}

}  // namespace

void OptimizePoseGraph(const std::vector<RelativePoseConstraint>& sequential,
                       const std::vector<RelativePoseConstraint>& closures,
                       std::vector<Pose2>* world_from_pose) {
  std::vector<Block> blocks;
  for (const Pose2& pose : *world_from_pose) blocks.push_back({pose.x, pose.y, pose.yaw});
  ceres::CauchyLoss loss(kCauchyScale);
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  AddEdges(sequential, nullptr, &blocks, &problem);
  AddEdges(closures, &loss, &blocks, &problem);
  if (blocks.empty() || !problem.HasParameterBlock(blocks.front().data())) return;
  problem.SetParameterBlockConstant(blocks.front().data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = kMaxIterations;
  options.num_threads = 1;  // more would make the sums depend on their number
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return;
  for (std::size_t i = 0; i < blocks.size(); ++i) (*world_from_pose)[i] = Pose2(blocks[i].data());
}

double EdgeChi2(const RelativePoseConstraint& edge, const std::vector<Pose2>& world_from_pose) {
  RelativePoseResidual residual;
  if (!MakeResidual(edge, &residual)) return 0.0;
  const Pose2& a = world_from_pose[edge.from];
  const Pose2& b = world_from_pose[edge.to];
  const Block block_a{a.x, a.y, a.yaw}, block_b{b.x, b.y, b.yaw};
  Eigen::Vector3d error;
  residual.Evaluate(block_a.data(), block_b.data(), error.data(), nullptr, nullptr);
  return error.squaredNorm();
}

}  // namespace plumbline
