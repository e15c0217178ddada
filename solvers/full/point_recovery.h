#ifndef PLUMBLINE_SOLVERS_FULL_POINT_RECOVERY_H_
#define PLUMBLINE_SOLVERS_FULL_POINT_RECOVERY_H_

#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/association/tangent_lines.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

/// The points of the graph, x, y each, at the minimum of its beam and manifold term for fixed poses
/// and lines:  m = h - C n d / s^2,  s^2 = sigma_M^2 / w + n^T C n,  with h the measured end of the
/// beam, C its covariance, d = n . h - offset, and w the robust weight at the minimum, found by
/// iteration. A point without a line, or whose line would cost more than leaving it where it is,
/// stays at h: so none moves by more than the robust gate, counted in sigmas of its beam. lines:
/// per return, as LinesFromRadius gives them. Shape terms are left out. displacements: if given,
/// what MeasureDisplacements would say of these points; collective then for a shared graph.
std::vector<double> RecoverPoints(const SlamGraph& graph, const std::vector<double>& poses,
                                  const TangentLines& lines, const FactorOptions& factors,
                                  ThreadPool* pool, PointDisplacements* displacements = nullptr);

/// How far the points of a state are from where its poses and the measurements put them.
PointDisplacements MeasureDisplacements(const SlamGraph& graph, const MapState& state,
                                        const FactorOptions& factors, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_FULL_POINT_RECOVERY_H_
