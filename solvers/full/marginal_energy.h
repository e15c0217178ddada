#ifndef PLUMBLINE_SOLVERS_FULL_MARGINAL_ENERGY_H_
#define PLUMBLINE_SOLVERS_FULL_MARGINAL_ENERGY_H_

#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/tangent_lines.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// How well poses, (x, y, yaw) each, explain the scans: the energy with every point at its optimum,
/// under the tangent lines that these poses themselves give (`lines`, from LinesFromRadius). It
/// compares states whose associations differ, where the joint energy cannot.
///
/// A return at signed distance d from its line costs rho(d^2 / s^2) / 2 with
/// s^2 = sigma_M^2 + n^T C n, C the world-frame covariance of its beam; the point that minimises
/// beam and manifold term together reaches this value (quadratic case). A return without a line
/// costs what an outlier costs, so losing lines never pays. Pose terms are added, and a host's own
/// terms with the points at the ends of their beams; shape terms, which tie points to each other,
/// are left out.
double MarginalEnergy(const SlamGraph& graph, const std::vector<double>& poses,
                      const TangentLines& lines, const FactorOptions& factors, ThreadPool* pool);

/// The same under the lines that the poses give at the fine radius: one measure for the states of
/// all rounds and all solvers.
double MarginalEnergy(const SlamGraph& graph, const std::vector<double>& poses,
                      const MeasuredSurface& surface, const SolverOptions& options,
                      ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_MARGINAL_ENERGY_H_
