#ifndef PLUMBLINE_SOLVERS_SOLVE_H_
#define PLUMBLINE_SOLVERS_SOLVE_H_

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

/// A map, and how it was found.
struct Solution {
  /// InvalidArgument on bad input, Unavailable where the solver failed: memory ran out, a callback
  /// threw. The message is that of the report; poses and points are then those of the start.
  Status status;
  std::vector<Pose2> poses;    ///< world_from_robot per pose of the graph
  std::vector<double> points;  ///< x, y [m] in the world, two numbers per return of the graph
  SolverSummary report;        ///< how it went: rounds, costs, the comparison with the start

  /// A map point, x, y [m] in the world. Needs a return id of the graph.
  Eigen::Vector2d point(std::size_t return_id) const {
    return {points[2 * return_id], points[2 * return_id + 1]};
  }
  /// A copy of poses and points for functions that take a state: covariances, residuals, the start
  /// of another Solve.
  MapState State() const;
};

/// Estimates all poses and all map points of the graph jointly: the maximum of the posterior of
/// odometry, relative poses, beams and the two map priors. Starts from the graph's initial poses,
/// which should be right to a few decimetres (SeedGraph brings them there); where odometry and
/// relative poses flatly contradict them, or scans contradict relative poses, from where the sound
/// ones put the poses, if that lowers the energy.
///
/// Fixed poses are constants: the start is put where they are, rigidly by the first of them, and no
/// solver moves them. Where custom factors hold the map instead (SlamGraph::fixed_poses), the start
/// is moved as a whole to where these cost least, and all poses are free.
///
/// The result is the best state seen over the rounds (of associations: judged by MarginalEnergy).
/// It was found without the held-out returns and is compared with the start by energy and by these
/// returns (see AcceptanceTest); then one last round takes them in. Where single steps of the
/// odometry that the start flatly contradicts have torn poses from the map, or are flatly
/// contradicted by the result, too, it is all done once more with these downweighted
/// (SolverSummary::downweighted_steps); stretches that fit clearly worse than at the start are put
/// back to its shape (SolverSummary::put_back). Relative poses that their own scans contradict do
/// not count (SolverSummary::ignored_edges, SolverOptions::test_edges). The result is the start,
/// bit for bit, if nothing was better; the message says by which yardstick.
///
/// InvalidArgument names the culprit: what the graph refused, bad options, no returns, scans that
/// match as mirror images only around the turns of the poses (beams counted from the wrong side, or
/// a laser that hangs upside down), or a start that is not finite, beyond 1e8 m or of another size
/// than the graph. Nothing is thrown from here.
///
/// Nothing is shared between calls: several threads may solve at a time, also the same graph.
///
/// kPoseGraph and kSgd move the poses by the relative poses alone, see built_in_solvers.h: they
/// need no returns, but fail likewise without relative poses. SolverOptions::own_solver puts a
/// solver of the host in the place of those of the library, SlamGraph::AddFactor adds factors.
Solution Solve(const SlamGraph& graph, const SolverOptions& options = SolverOptions());

/// Like Solve, from other poses. start.points may be empty: then they are where the measurements
/// put them, seen from its poses. Solvers over landmarks (SolverType::kReduced) need no memory for
/// them until the poses are found.
Solution Solve(const SlamGraph& graph, const SolverOptions& options, MapState start);

/// The residuals of one term, in standard deviations.
struct TermResiduals {
  std::string name;            ///< of the term
  int size = 0;                ///< numbers per residual
  std::vector<double> values;  ///< `size` for each residual, in the order of the term
};

/// What every term says against a state of a graph, in standard deviations. Indices are those of
/// the graph.
struct Residuals {
  /// Whitened errors of SlamGraph::odometry() and SlamGraph::relative_poses(), U e with the error e
  /// (x, y [m], yaw [rad]) in the frame of `from` and U^T U the inverse of its covariance. The
  /// squaredNorm() of one is chi-squared with three degrees of freedom: 99.9 % of sound
  /// constraints stay below 16.3.
  std::vector<Eigen::Vector3d> odometry;
  std::vector<Eigen::Vector3d> relative_poses;  ///< see odometry
  /// Per return, of its map point: range and bearing against what the laser read.
  std::vector<Eigen::Vector2d> beams;
  /// Per return, of its map point: distance from the tangent line of its surroundings. NaN: it has
  /// none.
  std::vector<double> surfaces;
  /// All further terms that have residuals, as custom factors do.
  std::vector<TermResiduals> others;
};

/// Evaluates the terms at a state, under the tangent lines that its poses give. After Solve, the
/// halves of the squares add up to the costs of SolverSummary::terms, unless its last round was
/// undone, or it downweighted steps or ignored relative poses which `options` do not; only those of
/// the manifold term are robust, and of the lines of that round, which differ a little where poses
/// still moved. Shape terms are left out. InvalidArgument, with nothing changed, on whatever Solve
/// refuses and on a point on top of its laser.
Status EvaluateResiduals(const SolverOptions& options, const SlamGraph& graph,
                         const MapState& state, Residuals* residuals);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SOLVE_H_
