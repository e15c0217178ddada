#ifndef PLUMBLINE_SOLVERS_SOLVER_INPUT_H_
#define PLUMBLINE_SOLVERS_SOLVER_INPUT_H_

#include <cmath>
#include <functional>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/solver_options.h"

namespace plumbline {

/// Whether a coordinate of the state [m or rad] is finite, and near enough for the cells of
/// surfaces to be numbered.
inline bool IsWithinReach(double coordinate) { return std::abs(coordinate) <= 1e8; }

/// Whether a graph can be solved: InvalidArgument names an option out of range or that does not go
/// with the others, a pose or point that is not finite or beyond 1e8, or the lack of any return
/// (of any relative pose, for solvers that look at nothing else).
Status CheckSolverInput(const SolverOptions& options, const SlamGraph& graph);

/// What a solver returns that has refused its input.
SolverSummary SolverFailure(const SolverOptions& options, const Status& status);

/// Calls solve, and gives its summary; what it throws becomes a failure.
SolverSummary CatchFailures(const SolverOptions& options,
                            const std::function<SolverSummary()>& solve);

/// Puts the state of a graph back, bit for bit, unless it is told to keep the new one.
class GivenState {
 public:
  /// Keeps the pointer, and a copy of the poses.
  explicit GivenState(SlamGraph* graph) : graph_(graph), poses_(graph->poses()) {}
  ~GivenState() {
    if (graph_ == nullptr) return;
    graph_->poses().swap(poses_);
    if (!points_.empty()) graph_->points().swap(points_);
  }
  GivenState(const GivenState&) = delete;
  GivenState& operator=(const GivenState&) = delete;

  /// Copies the points, which the caller is about to change. Not before that: they are the largest
  /// part of a graph.
  const std::vector<double>& CopyPoints() { return points_ = graph_->points(); }
  void KeepNewState() { graph_ = nullptr; }

 private:
  SlamGraph* graph_;
  std::vector<double> poses_, points_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SOLVER_INPUT_H_
