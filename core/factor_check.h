#ifndef PLUMBLINE_CORE_FACTOR_CHECK_H_
#define PLUMBLINE_CORE_FACTOR_CHECK_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "plumbline/core/custom_factor.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// The error of a factor by itself; empty: none. Ids are not checked.
std::string ProblemOfFactor(const CustomFactor& factor);

/// Number of residuals. Needs a factor without such a problem.
int NumResiduals(const CustomFactor& factor);

/// Calls a host's function, as ceres::CostFunction::Evaluate. False where that returns false or
/// throws, or anything is not finite.
bool EvaluateSafely(const ceres::CostFunction& cost, double const* const* blocks, double* residuals,
                    double** jacobians);

/// The poses and points of a factor, by the initial guesses of its graph.
struct SeenByFactor {
  std::vector<Pose2> poses;
  std::vector<Eigen::Vector2d> points;  ///< [m] in the world
};
SeenByFactor SeenBy(const SlamGraph& graph, const CustomFactor& factor);

/// How a factor holds the map in the world: its derivatives by a motion of all that it sees, x, y
/// [m] and yaw [rad] about the origin [m]. A row has unit length, or is zero where its residual
/// does not change, as that of a relative pose. No rows where the factor is undefined.
Eigen::MatrixX3d HoldOnWorld(const CustomFactor& factor, const SeenByFactor& seen,
                             const Eigen::Vector2d& origin);

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_FACTOR_CHECK_H_
