#include "plumbline/solvers/pose_graph/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "plumbline/core/float_environment.h"
#include "plumbline/factors/analytic_factor.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/sqrt_information.h"
#include "plumbline/solvers/interface/quiet_ceres.h"
#include "plumbline/solvers/pose_graph/uncertain_edges.h"

namespace plumbline {
namespace {

// A right edge may be hundreds of standard deviations off at the start: the loss begins wide enough
// for all and narrows by this factor down to kCauchyScale (graduated non-convexity, Blake &
// Zisserman 1987).
constexpr double kNarrowing = 4.0;
// A few do, but for edges that know one direction thousands of times better than the other.
constexpr int kMaxIterations = 200;

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

ceres::Solver::Options SolverSettings() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = 1e-9;
  // All but undamped: where stiff edges meet soft ones, damping turns the few steps of Gauss-Newton
  // into hundreds.
  options.initial_trust_region_radius = 1e12;
  options.num_threads = 1;  // more would make the sums depend on their number
  return options;
}

std::vector<Pose2> PosesOfBlocks(const std::vector<Block>& blocks) {
  std::vector<Pose2> poses;
  poses.reserve(blocks.size());
  for (const Block& block : blocks) poses.emplace_back(block.data());
  return poses;
}

class IterationReport final : public ceres::IterationCallback {
 public:
  IterationReport(const PoseGraphCallback& callback, const std::vector<Block>& blocks)
      : callback_(callback), blocks_(blocks) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    const bool go_on =
        iteration.iteration == 0 || !callback_ || callback_(iteration.cost, PosesOfBlocks(blocks_));
    return go_on ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const PoseGraphCallback& callback_;
  const std::vector<Block>& blocks_;
};

}  // namespace

PoseGraphResult OptimizePoseGraph(const std::vector<RelativePoseConstraint>& edges,
                                  const std::vector<RelativePoseConstraint>& uncertain_edges,
                                  std::vector<Pose2>* world_from_pose,
                                  const std::vector<int>& fixed,
                                  const PoseGraphCallback& callback) {
  const DefaultFloatEnvironment float_environment;
  std::vector<Block> blocks;
  for (const Pose2& pose : *world_from_pose) blocks.push_back({pose.x, pose.y, pose.yaw});
  ceres::LossFunctionWrapper loss(nullptr, ceres::TAKE_OWNERSHIP);
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  AddEdges(edges, nullptr, &blocks, &problem);
  AddEdges(uncertain_edges, &loss, &blocks, &problem);
  for (const int pose : fixed) {
    if (pose < static_cast<int>(blocks.size()) && problem.HasParameterBlock(blocks[pose].data())) {
      problem.SetParameterBlockConstant(blocks[pose].data());
    }
  }
  double worst_chi2 = 0.0;
  for (const RelativePoseConstraint& edge : uncertain_edges) {
    worst_chi2 = std::max(worst_chi2, EdgeChi2(edge, *world_from_pose));
  }
  double scale = kCauchyScale;
  while (scale * scale < worst_chi2) scale *= kNarrowing;
  IterationReport report(callback, blocks);
  ceres::Solver::Options settings = SolverSettings();
  settings.update_state_every_iteration = callback != nullptr;
  settings.callbacks.push_back(&report);
  ceres::Solver::Summary summary;
  PoseGraphResult result;
  for (; scale >= kCauchyScale && !result.stopped; scale /= kNarrowing) {
    loss.Reset(new ceres::CauchyLoss(scale), ceres::TAKE_OWNERSHIP);
    SolveQuietly(settings, &problem, &summary);
    // The first entry is the starting point; there is none if that could not be evaluated.
    result.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    for (const ceres::IterationSummary& it : summary.iterations) result.costs.push_back(it.cost);
    if (!summary.IsSolutionUsable()) break;
    result.stopped = summary.termination_type == ceres::USER_SUCCESS;
  }
  if (summary.IsSolutionUsable()) {
    *world_from_pose = PosesOfBlocks(blocks);
  }
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.stop_reason = summary.message;
  return result;
}

double EdgeChi2(const RelativePoseConstraint& edge, const std::vector<Pose2>& world_from_pose) {
  return EdgeChi2(edge, world_from_pose[edge.from], world_from_pose[edge.to]);
}

double EdgeChi2(const RelativePoseConstraint& edge, const Pose2& world_from_from,
                const Pose2& world_from_to) {
  RelativePoseResidual residual;
  if (!MakeResidual(edge, &residual)) return 0.0;
  const Pose2 &a = world_from_from, &b = world_from_to;
  const Block block_a{a.x, a.y, a.yaw}, block_b{b.x, b.y, b.yaw};
  Eigen::Vector3d error;
  residual.Evaluate(block_a.data(), block_b.data(), error.data(), nullptr, nullptr);
  return error.squaredNorm();
}

double WorstSigmaM(const RelativePoseConstraint& edge) {
  const Eigen::Matrix2d position = edge.covariance.topLeftCorner<2, 2>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(position, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(axes.eigenvalues()(1), 0.0));
}

double GraphChi2(const std::vector<RelativePoseConstraint>& edges,
                 const std::vector<Pose2>& world_from_pose) {
  double sum = 0.0;
  for (const RelativePoseConstraint& edge : edges) sum += EdgeChi2(edge, world_from_pose);
  return sum;
}

}  // namespace plumbline
