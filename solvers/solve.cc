#include "plumbline/solvers/solve.h"

#include <cstddef>
#include <string>
#include <utility>

#include "plumbline/solvers/refine_state.h"

namespace plumbline {

MapState Solution::State() const { return {PoseArray(poses), points}; }

Solution Solve(const SlamGraph& graph, const SolverOptions& options) {
  return Solve(graph, options, {graph.initial_poses(), {}});
}

Solution Solve(const SlamGraph& graph, const SolverOptions& options, MapState start) {
  Solution solution;
  bool is_refused = false;
  solution.report = RefineState(options, graph, &start, &is_refused);
  start.poses.resize(3 *
                     static_cast<std::size_t>(start.num_poses()));  // a bad start may have any size
  solution.poses = PosesOf(start.poses);
  solution.points = std::move(start.points);
  if (solution.report.IsSolutionUsable()) return solution;
  const std::string& message = solution.report.message;
  solution.status = is_refused ? Status::InvalidArgument(message) : Status::Unavailable(message);
  return solution;
}

}  // namespace plumbline
