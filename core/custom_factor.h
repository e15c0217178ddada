#ifndef PLUMBLINE_CORE_CUSTOM_FACTOR_H_
#define PLUMBLINE_CORE_CUSTOM_FACTOR_H_

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace ceres {
class CostFunction;
class LossFunction;
}  // namespace ceres

namespace plumbline {

/// A measurement with a cost function of the host: a position by GPS, a heading, a known wall.
/// SlamGraph::AddFactor adds one.
///
/// Factors that see poses only go with all solvers but kPoseGraph and kSgd, with SolveWindow,
/// IncrementalSolver and calibration. Factors that see points need a solver over points:
/// kAlternatingCg, kCeres over points, or a RoundsSolver.
struct CustomFactor {
  /// Factors of one name are one term of the energy, in reports and messages.
  std::string name;
  /// Whitened residuals, dimensionless: errors over their standard deviations. Parameter blocks:
  /// the poses, x, y [m], yaw [rad] of world_from_robot each, and then the points, x, y [m] in the
  /// world. May be called by several threads at a time, and may be shared by factors. Where it
  /// returns false, throws or is not finite, the state is refused.
  std::shared_ptr<const ceres::CostFunction> cost;
  std::vector<int> poses;           ///< ids, each once
  std::vector<std::size_t> points;  ///< ids of returns, each once
  /// Robust loss of the squared norm of the residuals, throws nothing; null: none.
  std::shared_ptr<ceres::LossFunction> loss;
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_CUSTOM_FACTOR_H_
