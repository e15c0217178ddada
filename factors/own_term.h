#ifndef PLUMBLINE_FACTORS_OWN_TERM_H_
#define PLUMBLINE_FACTORS_OWN_TERM_H_

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace ceres {
class CostFunction;
class LossFunction;
}  // namespace ceres

namespace plumbline {

/// One residual of a host, and what it sees.
struct OwnResidual {
  /// Whitened residuals, dimensionless: errors over their standard deviations. Parameter blocks:
  /// the poses, x, y [m], yaw [rad] of world_from_robot each, and then the points, x, y [m] in the
  /// world. May be called by several threads at a time, and may be shared by residuals. Where it
  /// returns false, throws or is not finite, the state is refused.
  std::shared_ptr<const ceres::CostFunction> cost;
  std::vector<int> poses;                               ///< ids, each once
  std::vector<std::size_t> points;                      ///< ids of returns, each once
  std::shared_ptr<ceres::LossFunction> loss = nullptr;  ///< robust loss, throws nothing; null: none
};

/// A term that a host adds to the energy (FactorOptions::own_terms): a position, a heading, a wall
/// that is known. test/solvers/own_term_test.cc has examples.
///
/// Residuals that see poses only go with all solvers but kPoseGraph and kSgd. Those that see points
/// need a solver that has them: kAlternatingCg, kCeres over points, or a RoundsSolver.
/// SolverOptions::Check says so. SolveWindow and SolvePoses leave out the residuals that see
/// something outside of the window, and IncrementalSolver those of poses that are still to come;
/// SolveWithCalibration refuses own terms.
struct OwnTerm {
  std::string name;    ///< for summaries and messages
  std::string unit;    ///< of what the residuals measure, for reports
  double sigma = 0.0;  ///< standard deviation of each residual in this unit; 0: several units
  std::vector<OwnResidual> residuals;  ///< all with the same number of rows

  /// Whether any residual sees a point.
  bool SeesPoints() const;

  /// False if a field is out of range or a cost function does not fit the blocks; *error, if not
  /// null, then says which. Ids are checked against the graph by the solvers.
  bool Check(std::string* error) const;
};

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_OWN_TERM_H_
