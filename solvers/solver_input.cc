#include "plumbline/solvers/solver_input.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/solvers/ceres_solver.h"

namespace plumbline {
namespace {

// Names the first block of `size` entries that is not within reach.
Status CheckState(const char* name, const std::vector<double>& values, std::size_t size) {
  const auto bad = std::find_if_not(values.begin(), values.end(), IsWithinReach);
  if (bad == values.end()) return Status::Ok();
  return Status::InvalidArgument(
      std::string(name) + " " + std::to_string((bad - values.begin()) / size) +
      " of the graph is " + (std::isfinite(*bad) ? "beyond 1e8 m or rad" : "not finite"));
}

}  // namespace

Status CheckSolverInput(const SolverOptions& options, const SlamGraph& graph) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  if (options.type == SolverType::kCeres) {
    PLUMBLINE_RETURN_IF_ERROR(CheckCeresOptions(options.ceres));
  }
  if (options.IsOverPatches() && options.association.neighborhood != NeighborhoodType::kRadius) {
    return Status::InvalidArgument(
        "association.neighborhood = " + std::string(ToString(options.association.neighborhood)) +
        " goes with solvers that take each point's neighbours; the "
        "reduced one cuts surfaces into patches");
  }
  if (options.type == SolverType::kCeres && options.ceres.reduced &&
      !options.reduced.lines_follow) {
    return Status::InvalidArgument(
        "reduced.lines_follow = false goes with the built-in steps; lines are parameters of Ceres' "
        "reduced problem");
  }
  PLUMBLINE_RETURN_IF_ERROR(CheckState("pose", graph.poses(), 3));
  PLUMBLINE_RETURN_IF_ERROR(CheckState("point", graph.points(), 2));
  if (MovesPosesOnly(options.type)) {
    if (!graph.relative_poses().empty()) return Status::Ok();
    return Status::InvalidArgument("the graph has no relative poses, and the solver " +
                                   std::string(ToString(options.type)) + " looks at nothing else");
  }
  if (graph.num_returns() > 0) return Status::Ok();
  return Status::InvalidArgument("the graph has no laser returns: nothing to build a map of");
}

SolverSummary SolverFailure(const SolverOptions& options, const Status& status) {
  SolverSummary failure;
  failure.solver = ToString(options.type);
  failure.message = status.message();
  return failure;
}

SolverSummary CatchFailures(const SolverOptions& options,
                            const std::function<SolverSummary()>& solve) {
  SolverSummary summary;
  const Status status = CatchExceptions([&] {
    summary = solve();
    return Status::Ok();
  });
  if (!status.ok()) summary = SolverFailure(options, status);
  return summary;
}

}  // namespace plumbline
