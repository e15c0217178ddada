#include "plumbline/solvers/solver_input.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/catch_exceptions.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/interface/solver.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"

namespace plumbline {
namespace {

// Names the first block of `size` entries that is not within reach.
Status CheckReach(const char* name, const std::vector<double>& values, std::size_t size) {
  const auto bad = std::find_if_not(values.begin(), values.end(), IsWithinReach);
  if (bad == values.end()) return Status::Ok();
  return Status::InvalidArgument(
      std::string(name) + " " + std::to_string((bad - values.begin()) / size) +
      " of the state is " + (std::isfinite(*bad) ? "beyond 1e8 m or rad" : "not finite"));
}

}  // namespace

Status CheckSolverInput(const SolverOptions& options, const SlamGraph& graph, const MapState& state,
                        bool needs_points) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  PLUMBLINE_RETURN_IF_ERROR(graph.status());
  PLUMBLINE_RETURN_IF_ERROR(CheckStateSize(graph, state, needs_points));
  PLUMBLINE_RETURN_IF_ERROR(CheckReach("pose", state.poses, 3));
  PLUMBLINE_RETURN_IF_ERROR(CheckReach("point", state.points, 2));
  PLUMBLINE_RETURN_IF_ERROR(CheckFactorsFit(graph, SolverOf(options)));
  PLUMBLINE_RETURN_IF_ERROR(CheckFactors(graph, state));
  if (options.MovesPosesOnly()) {
    if (!graph.relative_poses().empty()) return Status::Ok();
    return Status::InvalidArgument("the graph has no relative poses, and the solver " +
                                   std::string(SolverOf(options).name()) +
                                   " looks at nothing else");
  }
  if (SumOverPeers(graph.peers(), static_cast<double>(graph.num_returns())) > 0.0) {
    return Status::Ok();
  }
  return Status::InvalidArgument("the graph has no laser returns: nothing to build a map of");
}

Status CheckFactorsFit(const SlamGraph& graph, const Solver& solver) {
  for (std::size_t i = 0; i < graph.factors().size(); ++i) {
    const CustomFactor& factor = graph.factors()[i];
    const std::string name =
        "factor " + std::to_string(i) + " (\"" + factor.name + "\"): the solver " + solver.name();
    if (solver.MovesPosesOnly()) {
      return Status::InvalidArgument(name +
                                     " looks at relative poses only; reduced, "
                                     "alternating_cg and ceres take custom factors");
    }
    if (solver.IsOverLandmarks() && !factor.points.empty()) {
      return Status::InvalidArgument(name +
                                     " eliminates the points, which the factor sees; "
                                     "alternating_cg and ceres over points take it");
    }
  }
  return Status::Ok();
}

Status CheckStateSize(const SlamGraph& graph, const MapState& state, bool needs_points) {
  const std::size_t num_pose_coordinates = 3 * static_cast<std::size_t>(graph.num_poses());
  const std::size_t num_point_coordinates = 2 * graph.num_returns();
  const bool has_points =
      state.points.size() == num_point_coordinates || (!needs_points && state.points.empty());
  if (state.poses.size() == num_pose_coordinates && has_points) return Status::Ok();
  return Status::InvalidArgument(
      "the graph has " + std::to_string(graph.num_poses()) + " poses and " +
      std::to_string(graph.num_returns()) + " returns, which takes " +
      std::to_string(num_pose_coordinates) + " and " + std::to_string(num_point_coordinates) +
      " coordinates, but the state has " + std::to_string(state.poses.size()) + " and " +
      std::to_string(state.points.size()) + "; see SlamGraph::ExtendState");
}

Status CheckSurfaceSize(const SlamGraph& graph, const MeasuredSurface& surface) {
  if (surface.normals.size() == graph.num_returns()) return Status::Ok();
  return Status::InvalidArgument("the graph has " + std::to_string(graph.num_returns()) +
                                 " returns, but the surface " +
                                 std::to_string(surface.normals.size()) + " normals");
}

SolverSummary SolverFailure(const SolverOptions& options, const Status& status) {
  SolverSummary failure;
  failure.solver = SolverOf(options).name();
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
