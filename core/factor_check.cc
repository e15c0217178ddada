#include "plumbline/core/factor_check.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "plumbline/core/pose_frame.h"

namespace plumbline {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <typename Id>
bool IsRepeated(std::vector<Id> ids) {
  std::sort(ids.begin(), ids.end());
  return std::adjacent_find(ids.begin(), ids.end()) != ids.end();
}

bool AreFinite(const double* values, std::size_t size) {
  return std::all_of(values, values + size, [](double value) { return std::isfinite(value); });
}

}  // namespace

std::string ProblemOfFactor(const CustomFactor& factor) {
  if (factor.name.empty()) return "has no name";
  if (factor.cost == nullptr) return "has no cost function";
  if (factor.poses.empty() && factor.points.empty()) return "sees neither a pose nor a point";
  if (IsRepeated(factor.poses) || IsRepeated(factor.points)) return "sees a block twice";
  std::vector<std::int32_t> sizes(factor.poses.size(), 3);
  sizes.resize(sizes.size() + factor.points.size(), 2);
  if (factor.cost->parameter_block_sizes() != sizes) {
    std::string text = "sees " + std::to_string(factor.poses.size()) + " poses and " +
                       std::to_string(factor.points.size()) +
                       " points, blocks of 3 and 2, but its cost function has blocks of";
    for (const int size : factor.cost->parameter_block_sizes()) text += " " + std::to_string(size);
    return text;
  }
  return factor.cost->num_residuals() < 1 ? "has no residuals" : "";
}

int NumResiduals(const CustomFactor& factor) { return factor.cost->num_residuals(); }

bool EvaluateSafely(const ceres::CostFunction& cost, double const* const* blocks, double* residuals,
                    double** jacobians) {
  try {
    if (!cost.Evaluate(blocks, residuals, jacobians)) return false;
  } catch (...) {  // Ceres' threads cannot pass it on.
    return false;
  }
  const std::size_t num_rows = cost.num_residuals();
  if (!AreFinite(residuals, num_rows)) return false;
  const auto& sizes = cost.parameter_block_sizes();
  for (std::size_t b = 0; jacobians != nullptr && b < sizes.size(); ++b) {
    if (jacobians[b] != nullptr && !AreFinite(jacobians[b], num_rows * sizes[b])) return false;
  }
  return true;
}

SeenByFactor SeenBy(const SlamGraph& graph, const CustomFactor& factor) {
  SeenByFactor seen;
  for (const int id : factor.poses) seen.poses.push_back(graph.InitialPose(id));
  seen.points.reserve(factor.points.size());
  for (const std::size_t id : factor.points) {
    const int pose = graph.scan(graph.ScanOfReturn(id)).pose;
    seen.points.push_back(graph.InitialPose(pose) * graph.PointInRobot(id));
  }
  return seen;
}

Eigen::MatrixX3d HoldOnWorld(const CustomFactor& factor, const SeenByFactor& seen,
                             const Eigen::Vector2d& origin) {
  std::vector<Eigen::Vector3d> blocks;
  for (const Pose2& pose : seen.poses) blocks.emplace_back(pose.x, pose.y, pose.yaw);
  for (const Eigen::Vector2d& point : seen.points) blocks.emplace_back(point.x(), point.y(), 0.0);
  std::vector<const double*> values;
  std::vector<RowMajor> jacobians;
  std::vector<double*> derivatives;
  derivatives.reserve(blocks.size());
  Eigen::VectorXd residuals(NumResiduals(factor));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    values.push_back(blocks[b].data());
    jacobians.emplace_back(residuals.size(), b < seen.poses.size() ? 3 : 2);
  }
  for (RowMajor& jacobian : jacobians) derivatives.push_back(jacobian.data());
  if (!EvaluateSafely(*factor.cost, values.data(), residuals.data(), derivatives.data())) {
    return Eigen::MatrixX3d(0, 3);
  }
  Eigen::MatrixX3d hold = Eigen::MatrixX3d::Zero(residuals.size(), 3);
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(residuals.size());  // without cancellation
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Eigen::Vector2d lever = TurnedLeft(blocks[b].head<2>() - origin);
    const RowMajor& jacobian = jacobians[b];
    hold.leftCols<2>() += jacobian.leftCols<2>();
    hold.col(2) += jacobian.leftCols<2>() * lever;
    sizes += jacobian.leftCols<2>().rowwise().norm() * (1.0 + lever.norm());
    if (jacobian.cols() < 3) continue;
    hold.col(2) += jacobian.col(2);
    sizes += jacobian.col(2).cwiseAbs();
  }
  constexpr double kRounding = 1e-9;  // of sums that cancel
  for (Eigen::Index row = 0; row < hold.rows(); ++row) {
    const double norm = hold.row(row).norm();
    hold.row(row) *= norm > kRounding * sizes[row] ? 1.0 / norm : 0.0;
  }
  return hold;
}

}  // namespace plumbline
