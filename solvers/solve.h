#ifndef PLUMBLINE_SOLVERS_SOLVE_H_
#define PLUMBLINE_SOLVERS_SOLVE_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/return_normals.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/solver_options.h"
#include "plumbline/solvers/solver_summary.h"

namespace plumbline {

/// The window for surface normals that suits a laser of this range noise [m].
ReturnNormalOptions NormalOptionsFor(const RangeBeamOptions& beam);

/// Smallest radius [m] of the neighbourhoods that final tangent lines, and with them
/// MarginalEnergy, are taken from: fine_radius_m, or more where noise would make walls look like
/// clutter.
double FineRadius(const SolverOptions& options);

/// Estimates all poses and all map points of the graph jointly: the maximum of the posterior of
/// odometry, relative poses, beams and the two map priors. Starts from *state, which should be
/// right to a few decimetres (SeedGraph brings it there); where odometry and relative poses flatly
/// contradict it, from where these put the poses, if that lowers the energy.
///
/// Fixed poses are constants: *state is put where they are, rigidly by the first of them, and no
/// solver moves them.
///
/// On return *state is the best one seen over the rounds (of associations: judged by
/// MarginalEnergy). It was found without the held-out returns and is compared with the given state
/// by energy and by these returns (see Verdict); then one last round takes them in. Where single
/// steps of the odometry that the state flatly contradicts have torn poses from the map, it is all
/// done once more with these doubted (SolverSummary::doubted_steps); stretches that fit clearly
/// worse than in the given state are put back to its shape (SolverSummary::put_back). *state is the
/// given one, bit for bit, if nothing was better; the message says by which yardstick.
/// Bad options, no returns, scans that match as mirror images only around the turns of the poses
/// (beams counted from the wrong side, or a laser that hangs upside down), or a state that is not
/// finite, beyond 1e8 m or of another size than the graph: termination kFailure, the message names
/// the culprit, and *state is unchanged. So it is if memory runs out or the callback throws;
/// nothing is thrown from here.
///
/// Nothing is shared between calls: several threads may solve at a time, also the same graph.
///
/// kPoseGraph and kSgd move the poses by the relative poses alone, see built_in_solvers.h: they
/// need no returns, but fail likewise without relative poses. SolverOptions::own_solver puts a
/// solver of the host in the place of those of the library.
SolverSummary Solve(const SolverOptions& options, const SlamGraph& graph, MapState* state);

/// The same for a caller that has measured the surfaces already, with the normals that
/// NormalOptionsFor(options.factors.beam) gives. A surface of another number of returns: kFailure.
SolverSummary Solve(const SolverOptions& options, const MeasuredSurface& surface,
                    const SlamGraph& graph, MapState* state);

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
};

/// Evaluates the terms at a state, under the tangent lines that its poses give (and, for
/// NeighborhoodType::kNearest, its points). After Solve, the halves of the squares add up to the
/// costs of SolverSummary::terms, unless its last round was undone, or it doubted steps which
/// `options` do not; only those of the manifold term are robust, and of the lines of that round,
/// which differ a little where poses still moved. Shape terms are left out. InvalidArgument, with
/// nothing changed, on whatever Solve refuses and on a point on top of its laser.
Status EvaluateResiduals(const SolverOptions& options, const SlamGraph& graph,
                         const MapState& state, Residuals* residuals);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_SOLVE_H_
